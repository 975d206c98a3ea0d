//! Taps on a plugged layer that are not let in, and owners that do not do as they are told: the daemon goes on, and
//! nobody is held up.

mod scene;
mod tower;

use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock::Span;
use ipc::control::{Connection, Order, Plug, Reply, Request, Versions};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::creature::How;
use ipc::wiring::directory::Directory;
use scene::{Scene, wait_for};
use tower::{
    MIDDLE, TOP, TOWER, attached, bare, daemon, greeted, layer, lonely_top, on_stage, port, says, tap,
};

#[test]
fn what_is_not_open_on_a_plugged_layer_is_refused() {
    let stage = Scene::new("closed");
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

/// A level 1 that opens its input to all and does nothing: the daemon maps its page, and that is all it gets.
fn idle(stage: &Scene, leave: &Arc<AtomicBool>) -> Connection {
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
fn the_directory_shows_what_an_attached_layer_opens() {
    let stage = Scene::new("shown");
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
