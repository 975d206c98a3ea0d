//! Three processes: a daemon with level 0, a layer process of level 1 that taps it, and one of level 2 that taps
//! level 1. Each dies, and the others go on; each comes back, and is joined again.

mod stage;

use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock::{self, Span, Time};
use ipc::control::{Connection, Order, Plug, PlugTap, Reply, Request, Versions};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, Reader};
use ipc::wiring::creature::How;
use ipc::wiring::directory::{Directory, Listed};
use rustix::process::Signal;
use serde_json::Value;
use stage::{Player, Stage, wait_for};

/// The name of the running creature.
const TOWER: &str = "tower";

/// Time constant of every tap.
const TAU: Span = Span::millis(300);

/// Level 0: says 1 to itself.
const GROUND: &str = r#"
creature = "tower"
[[layer]]
name = "ground"
level = 0
period = "10ms"
wires = ["low.out -> ground.in"]
[layer.modules]
low = { kind = "constant", value = 1.0, every = "20ms" }
ground = { kind = "gain", factor = 1.0 }
[outsiders]
tap = ["ground.in"]
time_constant_max = "5s"
"#;

/// Level 1: says 2 to level 0, and 7 to whoever listens.
const MIDDLE: &str = r#"
creature = "tower"
[outsiders]
tap = ["relay.in", "beacon.out"]
read = ["relay.out", "mid.out"]
[[layer]]
name = "middle"
level = 1
period = "10ms"
wires = ["mid.out -> relay.in"]
suppress = [{ from = "relay.out", input = "ground.in", time_constant = "300ms" }]
[layer.modules]
mid = { kind = "constant", value = 2.0, every = "20ms" }
relay = { kind = "gain", factor = 1.0 }
beacon = { kind = "constant", value = 7.0, every = "20ms" }
"#;

/// Level 2: says 3 to level 1 and hushes its beacon; hears what level 1 says.
const TOP: &str = r#"
creature = "tower"
[[layer]]
name = "top"
level = 2
period = "10ms"
wires = ["relay.out -> ear.in"]
suppress = [{ from = "high.out", input = "relay.in", time_constant = "300ms" }]
inhibit = [{ from = "hush.out", output = "beacon.out", time_constant = "300ms" }]
[layer.modules]
high = { kind = "constant", value = 3.0, every = "20ms" }
hush = { kind = "constant", value = 0.0, every = "20ms" }
ear = { kind = "gain", factor = 1.0 }
"#;

/// Runs `test` in a process of its own whose domain and run directory are those of a stage, so that it can
/// read wires there. The stage, if this is that process.
fn on_stage(test: &str, short: &str) -> Option<Stage> {
    if let (Ok(domain), Some(run)) = (std::env::var("SUBSUMED_DOMAIN"), std::env::var_os("SUBSUMED_RUN")) {
        return Some(Stage {
            domain,
            run: PathBuf::from(run),
        });
    }
    let stage = Stage::new(short);
    let status = Command::new(std::env::current_exe().expect("this program has a path"))
        .args([test, "--exact", "--nocapture"])
        .env("SUBSUMED_DOMAIN", &stage.domain)
        .env("SUBSUMED_RUN", &stage.run)
        .stdin(Stdio::null())
        .status()
        .expect("this program starts");
    assert!(status.success(), "{test} on its stage: {status}");
    None
}

fn daemon(stage: &Stage) -> Player {
    let file = stage.run.join("tower.toml");
    std::fs::write(&file, GROUND).expect("the stage takes files");
    stage.daemon(TOWER, &["--creature", &file.display().to_string()])
}

/// A layer process of this manifest.
fn layer(stage: &Stage, name: &str, manifest: &str) -> Player {
    let file = stage.run.join(format!("{name}.toml"));
    std::fs::write(&file, manifest).expect("the stage takes files");
    let daemon = std::path::Path::new(env!("CARGO_BIN_EXE_subsumed"));
    let program = daemon.with_file_name("examples").join("layer");
    let manifest = file.display().to_string();
    stage.start_with(program, &[], &[("LAYER_MANIFEST", &manifest)])
}

fn attached(stage: &Stage, name: &str, manifest: &str) -> Player {
    let player = layer(stage, name, manifest);
    wait_for(
        &format!("{name} is attached, so far: {:?}", player.said()),
        || stage.has_layer(TOWER, name),
    );
    player
}

/// One of a list of the status, by what `key` says.
fn listed(stage: &Stage, list: &str, key: &str, name: &str) -> Value {
    let status = stage.status(TOWER);
    let mut items = status[list].as_array().into_iter().flatten();
    items
        .find(|item| item[key] == name)
        .cloned()
        .unwrap_or(Value::Null)
}

fn says(stage: &Stage, wire: &str) -> f64 {
    listed(stage, "wires", "wire", wire)["value"]
        .as_f64()
        .unwrap_or(f64::NAN)
}

fn messages(stage: &Stage, wire: &str) -> u64 {
    listed(stage, "wires", "wire", wire)["messages"]
        .as_u64()
        .unwrap_or(0)
}

fn tap(stage: &Stage, from: &str) -> Value {
    listed(stage, "taps", "from", from)
}

/// Ends of the wires of an attached layer, mapped like anybody's.
fn readers<const N: usize>(layer: &str, indices: [usize; N]) -> (Arc<Page>, [Reader; N]) {
    let domain = Domain::join("watcher").expect("shared memory works");
    let page = domain
        .map(&format!("{TOWER}/{layer}"))
        .expect("it shares its wires");
    let readers = indices.map(|index| page.reader(index, Kind::Number).expect("it has that wire"));
    // For as long as this process lives.
    std::mem::forget(domain);
    (page, readers)
}

fn stamp(reader: &Reader) -> Time {
    reader.read().expect("it was written").stamp
}

fn value(reader: &Reader) -> f64 {
    reader.read().expect("it was written").words[0]
}

#[test]
fn level_2_taps_level_1_and_each_may_die() {
    let Some(stage) = on_stage("level_2_taps_level_1_and_each_may_die", "tower") else {
        return;
    };
    let mut daemon = daemon(&stage);
    wait_for("level 0 speaks for itself", || says(&stage, "ground.out") == 1.0);
    let mut middle = attached(&stage, "middle", MIDDLE);
    wait_for("level 1 is heard", || says(&stage, "ground.out") == 2.0);
    let mut top = attached(&stage, "top", TOP);
    wait_for("level 2 is heard through level 1", || {
        says(&stage, "ground.out") == 3.0
    });
    assert!(stage.happened(
        TOWER,
        &["tap high.out > relay.in of layer top joined at layer middle"]
    ));
    let suppressor = tap(&stage, "high.out");
    assert_eq!(
        (&suppressor["at"], &suppressor["joined"]),
        (&"middle".into(), &true.into())
    );
    assert_eq!(suppressor["holds"], true);
    // The owner's own counts, told by its process.
    wait_for("both taps are counted", || {
        let (suppressor, inhibitor) = (tap(&stage, "high.out"), tap(&stage, "hush.out"));
        let both = [
            &suppressor["delivered"],
            &suppressor["rejected"],
            &inhibitor["delivered"],
            &inhibitor["rejected"],
        ];
        both.iter().all(|count| count.as_u64() > Some(3))
    });
    hushed(&stage);

    // Level 2 dies: level 1 is as it was after τ, and not before.
    let (_top_page, [high]) = readers("top", [0]);
    let (_middle_page, [mid, relay]) = readers("middle", [0, 1]);
    top.kill();
    let last = stamp(&high);
    wait_for("level 1 speaks for itself again", || value(&relay) == 2.0);
    let first = stamp(&relay);
    assert!(
        first >= last + TAU,
        "{} before the window ran out",
        (last + TAU).since(first)
    );
    assert!(stamp(&mid) >= last + TAU);
    wait_for("level 0 hears level 1", || says(&stage, "ground.out") == 2.0);
    let before = messages(&stage, "beacon.out");
    wait_for("the beacon is heard again", || {
        messages(&stage, "beacon.out") > before + 3
    });
    assert!(stage.has_layer(TOWER, "middle"));
    wait_for("its taps are let go", || {
        stage.happened(
            TOWER,
            &["layer middle released the taps of a layer that has gone"],
        )
    });

    // It comes back and is joined again; then level 1 dies under it.
    let top = attached(&stage, "top", TOP);
    wait_for("level 2 is heard again", || says(&stage, "ground.out") == 3.0);
    middle.kill();
    wait_for("level 0 speaks for itself again", || {
        says(&stage, "ground.out") == 1.0
    });
    assert!(stage.has_layer(TOWER, "top"), "level 2 stays, if only for itself");
    top.says("layer middle is gone", 1);
    wait_for("its taps wait", || {
        stage.happened(
            TOWER,
            &["tap high.out > relay.in of layer top waits for layer middle"],
        )
    });
    let waiting = tap(&stage, "high.out");
    assert_eq!(
        (&waiting["joined"], &waiting["holds"]),
        (&false.into(), &false.into())
    );
    let heard = messages(&stage, "ear.out");

    // Level 1 comes back: it is tapped again, and heard again.
    let joined = || {
        let joined =
            |e: &ipc::control::Event| e.text.contains("tap hush.out > beacon.out of layer top joined");
        stage.events(TOWER).iter().filter(|e| joined(e)).count()
    };
    let before = joined();
    let mut middle = attached(&stage, "middle", MIDDLE);
    wait_for("level 2 is heard through the new level 1", || {
        says(&stage, "ground.out") == 3.0
    });
    wait_for("both taps are joined anew", || joined() == before + 1);
    wait_for("level 2 hears the new level 1", || {
        messages(&stage, "ear.out") > heard + 3
    });
    hushed(&stage);
    // The new one is another process: it counts from the beginning, what is shown goes on.
    let counted = waiting["delivered"].as_u64().expect("a count");
    wait_for("counts go on", || {
        tap(&stage, "high.out")["delivered"].as_u64() > Some(counted + 3)
    });
    assert!(middle.leave().success());
    wait_for("it detached", || {
        stage.happened(TOWER, &["layer middle", "detached"])
    });
    assert!(stage.has_layer(TOWER, "top"));
    drop(top);
    assert!(daemon.leave().success());
}

/// The beacon says nothing while level 2 says a lot.
fn hushed(stage: &Stage) {
    wait_for("the beacon is hushed", || {
        let (before, hush) = (messages(stage, "beacon.out"), messages(stage, "hush.out"));
        wait_for("level 2 goes on", || messages(stage, "hush.out") > hush + 5);
        messages(stage, "beacon.out") == before
    });
}

#[test]
fn what_is_not_open_on_a_plugged_layer_is_refused() {
    let stage = Stage::new("closed");
    let mut daemon = daemon(&stage);
    let _middle = attached(&stage, "middle", MIDDLE);
    let refused = |what: &str, change: (&str, &str), reason: &str| {
        assert!(TOP.contains(change.0), "{what} changes something");
        let mut player = layer(&stage, "top", &TOP.replace(change.0, change.1));
        assert_eq!(player.end().code(), Some(2), "{what}: {:?}", player.said());
        wait_for(&format!("{what}: {reason:?} in {:?}", player.said()), || {
            player.said().join("\n").contains(reason)
        });
    };
    refused(
        "a port that is not open",
        ("\"beacon.out\"", "\"mid.out\""),
        "does not open mid.out to taps",
    );
    refused(
        "a port that is not there",
        ("\"beacon.out\"", "\"beacon.oot\""),
        "has no output \"oot\"",
    );
    refused(
        "too long a time constant",
        (
            "input = \"relay.in\", time_constant = \"300ms\"",
            "input = \"relay.in\", time_constant = \"6s\"",
        ),
        "the time constant 6s is too long",
    );
    refused(
        "a tap upward",
        ("level = 2", "level = 1"),
        "relay.in is of level 1",
    );
    refused(
        "a wire that is not to be read",
        ("\"relay.out -> ear.in\"", "\"beacon.out -> ear.in\""),
        "does not let outsiders read beacon.out",
    );
    assert!(!stage.has_layer(TOWER, "top"));

    // A newcomer that checks nothing itself gets the same answers from the daemon.
    let refused = |change: &dyn Fn(&mut Plug)| {
        let mut plug = bare("liar", 2, "liar.out", "relay.in");
        change(&mut plug);
        let mut connection = greeted(&stage);
        match connection.ask(&Request::Plug(plug)).expect("the daemon answers") {
            Reply::Refused { reasons } => reasons.join("; "),
            other => panic!("a plug was answered with {other:?}"),
        }
    };
    assert!(refused(&|p| p.taps[0].to = "mid.out".into()).contains("no such port mid.out"));
    assert!(
        refused(&|p| (p.taps[0].to, p.taps[0].how) = ("mid.out".into(), How::Inhibit))
            .contains("does not open mid.out")
    );
    assert!(refused(&|p| p.taps[0].time_constant = Span::secs(6)).contains("too long"));
    assert!(refused(&|p| p.level = 1).contains("relay.in is not of a level below 1"));
    assert!(refused(&|p| p.outputs[0].kind = Kind::Pulse).contains("does not carry what relay.in takes"));
    assert!(
        refused(&|p| p.outputs[0].name = "relay.other".into())
            .contains("a module \"relay\" is there already")
    );
    assert!(
        refused(&|p| p.open_taps = vec!["ground.out".into()])
            .contains("it opens ground.out, which is not its own")
    );
    let mut stranger =
        Connection::over(UnixStream::connect(stage.socket(TOWER)).expect("the daemon listens"))
            .expect("a socket can be cloned");
    let versions = Versions {
        protocol: Versions::ours().protocol - 1,
        ..Versions::ours()
    };
    let hello = Request::Hello {
        versions,
        program: "old".into(),
    };
    let answer = stranger.ask(&hello).expect("the daemon answers");
    assert!(
        matches!(&answer, Reply::Refused { reasons } if reasons[0].contains("protocol 1")),
        "{answer:?}"
    );
    assert_eq!(says(&stage, "ground.out"), 2.0, "level 1 never noticed");
    assert!(daemon.leave().success());
}

/// What a newcomer asks that suppresses an input with the one wire that it has.
fn bare(layer: &str, level: u8, from: &str, to: &str) -> Plug {
    let owner = format!("{TOWER}/{layer}");
    Plug {
        layer: layer.into(),
        level,
        period: Span::millis(20),
        pid: 1,
        owner: owner.clone(),
        outputs: vec![port(from, level)],
        inputs: Vec::new(),
        open_taps: Vec::new(),
        open_reads: None,
        neighbours: Vec::new(),
        modules: Vec::new(),
        wires: Vec::new(),
        taps: vec![PlugTap {
            how: How::Suppress,
            from: from.into(),
            to: to.into(),
            time_constant: TAU,
        }],
    }
}

fn port(name: &str, level: u8) -> Listed {
    Listed {
        name: name.into(),
        kind: Kind::Number,
        unit: String::new(),
        level: Some(level),
        owner: String::new(),
        index: 0,
        plug: 0,
    }
}

fn greeted(stage: &Stage) -> Connection {
    let stream = UnixStream::connect(stage.socket(TOWER)).expect("the daemon listens");
    let mut connection = Connection::over(stream).expect("a socket can be cloned");
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: "tester".into(),
    };
    let welcome = connection.ask(&hello).expect("the daemon answers");
    assert!(matches!(welcome, Reply::Welcome { .. }), "{welcome:?}");
    connection
}

/// A level 1 that opens its input to all and does nothing: the daemon maps its page, and that is all it gets.
fn idle(stage: &Stage, leave: &Arc<AtomicBool>) -> Connection {
    let domain = Domain::join("idle").expect("shared memory works");
    let owned = domain.own(&format!("{TOWER}/idle"), 1).expect("a page");
    let left = leave.clone();
    std::thread::spawn(move || {
        while !left.load(Ordering::Relaxed) {
            owned.serve();
            std::thread::sleep(Duration::from_millis(2));
        }
        drop(owned);
        domain.leave();
    });
    let mut connection = greeted(stage);
    let mut plug = bare("idle", 1, "idle.out", "ground.in");
    plug.inputs = vec![port("relay.in", 1)];
    plug.open_taps = vec!["relay.in".into()];
    let answer = connection.ask(&Request::Plug(plug)).expect("the daemon answers");
    assert!(matches!(answer, Reply::Plugged { .. }), "{answer:?}");
    connection
}

/// Level 2 without what only a real level 1 has.
fn lonely_top() -> String {
    let top = TOP
        .replace("wires = [\"relay.out -> ear.in\"]\n", "")
        .replace("ear = { kind = \"gain\", factor = 1.0 }\n", "");
    let mut lines: Vec<&str> = top.lines().collect();
    lines.retain(|line| !line.starts_with("inhibit"));
    lines.join("\n")
}

#[test]
fn an_owner_that_does_not_answer_or_lies_is_let_go_and_holds_nobody_up() {
    let Some(stage) = on_stage(
        "an_owner_that_does_not_answer_or_lies_is_let_go_and_holds_nobody_up",
        "mute",
    ) else {
        return;
    };
    let mut daemon = daemon(&stage);
    let leave = Arc::new(AtomicBool::new(false));
    let mut mute = idle(&stage, &leave);
    let top = attached(&stage, "top", &lonely_top());
    // The order is there; it is never answered. Everybody else is, all the while.
    let order: Option<Reply> = mute.receive().expect("the daemon speaks");
    assert!(
        matches!(
            order,
            Some(Reply::Order {
                number: 1,
                order: Order::Join(_)
            })
        ),
        "{order:?}"
    );
    assert_eq!(tap(&stage, "high.out")["joined"], false);
    let mut asked = 0;
    wait_for("it is let go", || {
        asked += 1;
        stage.happened(TOWER, &["layer idle has not answered an order within 5s"])
    });
    assert!(asked > 50, "the daemon answered {asked} times meanwhile");
    assert!(
        matches!(mute.receive::<Reply>(), Ok(None) | Err(_)),
        "its connection is closed"
    );
    assert!(stage.has_layer(TOWER, "top"));
    drop(mute);
    leave.store(true, Ordering::Relaxed);

    // Who answers what was never asked is let go at once, and so is nobody else.
    wait_for("the name is free", || !stage.has_layer(TOWER, "idle"));
    let leave = Arc::new(AtomicBool::new(false));
    let mut liar = idle(&stage, &leave);
    let order: Option<Reply> = liar.receive().expect("the daemon speaks");
    assert!(
        matches!(order, Some(Reply::Order { .. })),
        "{order:?}: the tap waited for it"
    );
    let lie = Request::Obeyed {
        order: 77,
        refused: None,
    };
    liar.send(&lie).expect("the daemon listens");
    wait_for("it is let go", || {
        stage.happened(TOWER, &["layer idle answered an order that it was never given"])
    });
    assert!(
        matches!(liar.receive::<Reply>(), Ok(None) | Err(_)),
        "its connection is closed"
    );
    leave.store(true, Ordering::Relaxed);
    assert!(stage.has_layer(TOWER, "top") && says(&stage, "ground.out") == 1.0);
    drop(top);
    assert!(daemon.leave().success());
}

#[test]
fn a_stopped_owner_comes_back_and_is_tapped_again() {
    let stage = Stage::new("stopped");
    let mut daemon = daemon(&stage);
    let middle = attached(&stage, "middle", MIDDLE);
    middle.signal(Signal::STOP);
    wait_for("level 0 speaks for itself again", || {
        says(&stage, "ground.out") == 1.0
    });
    // Whoever reads wires maps the page first, and nobody hands that out now.
    let _top = attached(&stage, "top", &lonely_top());
    wait_for("level 1 is let go", || !stage.has_layer(TOWER, "middle"));
    assert!(stage.has_layer(TOWER, "top"));
    middle.signal(Signal::CONT);
    wait_for("level 2 is heard through level 1", || {
        says(&stage, "ground.out") == 3.0
    });
    assert!(daemon.leave().success());
}

#[test]
fn the_directory_shows_what_an_attached_layer_opens() {
    let stage = Stage::new("shown");
    let mut daemon = daemon(&stage);
    let directory = || -> Directory {
        match stage.ask(TOWER, &Request::Directory) {
            Some(Reply::Directory(directory)) => directory,
            other => panic!("{other:?} instead of a directory"),
        }
    };
    let before = directory();
    assert_eq!(
        (&before.open_taps, &before.open_reads),
        (&vec!["ground.in".to_string()], &None)
    );
    let mut middle = attached(&stage, "middle", MIDDLE);
    let with = directory();
    assert_eq!(with.open_taps, ["ground.in", "relay.in", "beacon.out"]);
    let mut reads = with.open_reads.expect("no longer all of them");
    reads.sort();
    assert_eq!(reads, ["ground.out", "low.out", "mid.out", "relay.out"]);
    let relay = with
        .inputs
        .iter()
        .find(|i| i.name == "relay.in")
        .expect("its inputs are listed");
    assert_eq!(relay.level, Some(1));
    assert!(middle.leave().success());
    wait_for("it is as before", || directory() == before);
    assert!(daemon.leave().success());
}
