//! A body in a process of its own: halted unless a living daemon drives it, and neither end needs the other
//! to start in any order or to stay.

mod scene;

use rustix::process::Signal;
use scene::{Scene, wait_for};

#[test]
fn a_killed_daemon_halts_the_body_and_the_next_one_drives_it_again() {
    let stage = Scene::new("bodykill");
    let mut body = stage.body("hall");
    let mut daemon = stage.daemon("first", &["--body", "hall"]);
    body.says("free to move", 1);
    daemon.kill();
    body.says("halted: stale command", 1);
    let mut daemon = stage.daemon("first", &["--body", "hall"]);
    body.says("free to move", 2);
    wait_for("the daemon is free", || stage.is_free("first"));
    assert!(daemon.leave().success());
    body.says("halted", 2);
    assert!(body.leave().success());
    assert_eq!(stage.files(), Vec::<std::path::PathBuf>::new());
}

#[test]
fn a_frozen_daemon_halts_the_body_and_goes_on_when_it_thaws() {
    let stage = Scene::new("bodystop");
    let body = stage.body("hall");
    let daemon = stage.daemon("frozen", &["--body", "hall"]);
    body.says("free to move", 1);
    daemon.signal(Signal::STOP);
    body.says("halted: stale command", 1);
    daemon.signal(Signal::CONT);
    body.says("free to move", 2);
    wait_for("the daemon is free", || stage.is_free("frozen"));
    assert!(
        !stage.happened("frozen", &["vital layer late"]),
        "a freeze of everybody is nobody's fault"
    );
}

#[test]
fn a_lost_body_halts_until_one_of_its_name_is_back() {
    let stage = Scene::new("bodylost");
    let daemon = stage.daemon("alone", &["--body", "hall"]);
    wait_for("it says what is missing", || {
        stage.happened("alone", &["no body \"hall\"", "subsumed-body"])
    });
    wait_for("the body is lost", || {
        stage.causes("alone").contains(&"body lost".to_string())
    });
    let mut body = stage.body("hall");
    wait_for("the daemon is free", || stage.is_free("alone"));
    // Frozen first: it still has its socket, but no pulse.
    body.signal(Signal::STOP);
    wait_for("the body is lost", || {
        stage.causes("alone").contains(&"body lost".to_string())
    });
    body.signal(Signal::CONT);
    wait_for("the daemon is free again", || stage.is_free("alone"));
    body.kill();
    wait_for("the body is lost", || {
        stage.causes("alone").contains(&"body lost".to_string())
    });
    let _body = stage.body("hall");
    wait_for("the daemon is free once more", || stage.is_free("alone"));
    let counts = stage.status("alone")["halt"]["counts"].clone();
    let lost = counts
        .as_array()
        .into_iter()
        .flatten()
        .find(|c| c["cause"] == "body lost");
    assert_eq!(lost.and_then(|c| c["count"].as_u64()), Some(3), "{counts}");
    drop(daemon);
}

#[test]
fn one_daemon_drives_a_body_and_one_process_runs_it() {
    let stage = Scene::new("bodytwo");
    let body = stage.body("hall");
    body.says("waits for a daemon", 1);
    let mut second = stage.body("hall");
    assert_eq!(second.end().code(), Some(1));
    assert!(
        second
            .said()
            .iter()
            .any(|l| l.contains("runs a body of this name already"))
    );
    let _first = stage.daemon("first", &["--body", "hall"]);
    body.says("driven by first", 1);
    let _other = stage.daemon("other", &["--body", "hall"]);
    wait_for("the second is refused", || {
        stage.happened("other", &["first drives this body already"])
    });
    wait_for("it has no body", || {
        stage.causes("other").contains(&"body lost".to_string())
    });
    wait_for("the first drives on", || stage.is_free("first"));
}

#[test]
fn bad_names_and_bodies_are_bad_input() {
    let stage = Scene::new("bodybad");
    for (arguments, expected) in [
        (["--body", "a/b"], "--body \"a/b\": expected 1 to 48 letters"),
        (["--body", ""], "--body \"\": expected 1 to 48 letters"),
    ] {
        let mut daemon = stage.start(env!("CARGO_BIN_EXE_subsumed"), &arguments);
        assert_eq!(daemon.end().code(), Some(2));
        wait_for("it says why", || {
            daemon.said().iter().any(|l| l.contains(expected))
        });
    }
    let mut body = stage.start(
        env!("CARGO_BIN_EXE_subsumed-body"),
        &["--creature", "/nowhere.toml"],
    );
    assert_eq!(body.end().code(), Some(2));
}
