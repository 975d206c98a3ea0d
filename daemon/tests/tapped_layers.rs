//! Three processes: a daemon with level 0, a layer process of level 1 that taps it, and one of level 2 that taps
//! level 1. Each dies, and the others go on; each comes back, and is joined again.

mod scene;
mod tower;

use std::io::Read;
use std::sync::Arc;

use ipc::clock::Time;
use ipc::control::{Reply, Request};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, Reader};
use recording::{Recording, why};
use rustix::process::Signal;
use scene::{Scene, wait_for};
use tower::{MIDDLE, TAU, TOP, TOWER, attached, daemon, greeted, lonely_top, messages, on_stage, says, tap};

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
        // What the suppressor keeps out is counted only where a beat sees it before the tap's next message: whether
        // it ever does hangs on how the beats of the two processes lie.
        let counts = [
            &suppressor["delivered"],
            &inhibitor["delivered"],
            &inhibitor["rejected"],
        ];
        counts.iter().all(|count| count.as_u64() > Some(3))
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
fn hushed(stage: &Scene) {
    wait_for("the beacon is hushed", || {
        let (before, hush) = (messages(stage, "beacon.out"), messages(stage, "hush.out"));
        wait_for("level 2 goes on", || messages(stage, "hush.out") > hush + 5);
        messages(stage, "beacon.out") == before
    });
}

/// What the daemon remembers of the last minute, as `subsumectl` asks for it.
fn past(stage: &Scene) -> Recording {
    let mut connection = greeted(stage);
    let request = Request::Record {
        past: true,
        seconds: Some(0.0),
        ring: None,
    };
    let answer = connection.ask(&request).expect("the daemon answers");
    assert!(matches!(answer, Reply::Recording), "{answer:?}");
    let mut bytes = Vec::new();
    connection.rest().read_to_end(&mut bytes).expect("a recording");
    recording::reader::parse(&bytes).expect("a sound one")
}

#[test]
fn who_holds_a_port_of_a_plugged_layer_and_why_can_be_asked() {
    let stage = Scene::new("asked");
    // Without a flight recorder nothing but the newest of everything is remembered.
    let mut daemon = tower::daemon_with(&stage, &["--flight-recorder", "off"]);
    let mut middle = attached(&stage, "middle", MIDDLE);
    let _top = attached(&stage, "top", TOP);
    wait_for("level 2 is heard", || says(&stage, "ground.out") == 3.0);
    let holder = |port: &str| {
        let recording = past(&stage);
        let at = recording.beats.iter().flatten().map(|b| Time(b.commit_ns)).max();
        let holders = why::holders(&recording, at.expect("there are beats"));
        holders.into_iter().find(|h| h.port == port)
    };
    wait_for("level 2 holds level 1", || {
        let relay = holder("relay.in").expect("it is tapped");
        relay.layer.as_deref() == Some("top") && relay.next.as_deref() == Some("mid.out")
    });
    wait_for("and hushes it", || {
        let beacon = holder("beacon.out").expect("it is tapped");
        beacon.holder.as_deref() == Some("hush.out")
    });
    wait_for("level 1 holds level 0", || {
        holder("ground.in").expect("it is tapped").layer.as_deref() == Some("middle")
    });
    wait_for("the chain leads through both processes", || {
        let recording = past(&stage);
        let at = recording.beats.iter().flatten().map(|b| Time(b.commit_ns)).max();
        let link = why::why(&recording, "ground.out", at.expect("there are beats")).expect("it speaks");
        let chain = serde_json::to_string(&link).expect("a chain is JSON");
        ["relay.out", "relay.in", "high.out"]
            .iter()
            .all(|name| chain.contains(&format!("\"{name}\"")))
    });
    middle.kill();
    wait_for("its ports are nobody's", || {
        holder("relay.in").is_none() && holder("beacon.out").is_none()
    });
    assert!(daemon.leave().success());
}

#[test]
fn a_layer_may_wait_for_the_one_that_it_taps() {
    let stage = Scene::new("waits");
    let mut daemon = daemon(&stage);
    let mut top = tower::layer_with(&stage, "top", TOP, &["--wait"]);
    top.says("there is no module \"relay\"", 1);
    let _middle = attached(&stage, "middle", MIDDLE);
    wait_for("level 2 is heard", || says(&stage, "ground.out") == 3.0);
    assert!(top.leave().success());
    assert!(daemon.leave().success());
}

#[test]
fn a_stopped_owner_comes_back_and_is_tapped_again() {
    let stage = Scene::new("stopped");
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
