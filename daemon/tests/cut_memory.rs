//! A process of the same user cuts shared memory short under a daemon or a body: both halt and leave with a
//! failure, and the next start works.

mod scene;

use std::fs::File;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;

use scene::{Scene, segments, wait_for};

fn cut(segment: &PathBuf) {
    let file = File::options()
        .write(true)
        .open(segment)
        .expect("the same user may");
    file.set_len(0).expect("the same user may");
}

#[test]
fn a_daemon_whose_wires_are_cut_halts_leaves_and_starts_again() {
    let stage = Scene::new("cutwires");
    let mut daemon = stage.daemon("cut", &[]);
    wait_for("the body is free", || stage.is_free("cut"));
    let segments = segments(&stage);
    assert_eq!(segments.len(), 1, "{segments:?}");
    cut(&segments[0]);
    assert_eq!(daemon.end().code(), Some(1));
    daemon.says("the body is halted: shared memory cut", 1);
    let mut daemon = stage.daemon("cut", &[]);
    wait_for("the body is free", || stage.is_free("cut"));
    assert!(daemon.leave().success());
    assert_eq!(stage.files(), Vec::<PathBuf>::new());
}

#[test]
fn a_layer_that_cuts_its_own_wires_halts_the_body_too() {
    let stage = Scene::new("cutlayer");
    let mut daemon = stage.daemon("cut", &[]);
    let before = segments(&stage);
    let mut wander = stage.wander("cut");
    wait_for("wander is attached", || stage.has_layer("cut", "wander"));
    let of_wander: Vec<PathBuf> = segments(&stage)
        .into_iter()
        .filter(|s| !before.contains(s))
        .collect();
    assert_eq!(of_wander.len(), 1, "{of_wander:?}");
    // Awake it would hit the hole first, die, and be let go of like any dead layer.
    wander.signal(rustix::process::Signal::STOP);
    cut(&of_wander[0]);
    assert_eq!(daemon.end().code(), Some(1));
    daemon.says("the body is halted: shared memory cut", 1);
    wander.kill();
    let mut daemon = stage.daemon("cut", &[]);
    wait_for("the body is free", || stage.is_free("cut"));
    assert!(daemon.leave().success());
}

#[test]
fn a_body_process_whose_sensors_are_cut_halts_and_leaves() {
    let stage = Scene::new("cutbody");
    let mut body = stage.body("hall");
    body.says("waits for a daemon", 1);
    let of_body = segments(&stage);
    assert_eq!(of_body.len(), 1, "{of_body:?}");
    let mut daemon = stage.daemon("cut", &["--body", "hall"]);
    body.says("free to move", 1);
    // Commands reach the body before the daemon reads its sensors: a page cut in between is one it never touches.
    wait_for("the daemon hears the body", || stage.is_free("cut"));
    cut(&of_body[0]);
    assert_eq!(body.end().code(), Some(1));
    body.says("cut short by another process; halted, and left", 1);
    // The daemon reads that page too.
    assert_eq!(daemon.end().code(), Some(1));
    let mut body = stage.body("hall");
    let mut daemon = stage.daemon("cut", &["--body", "hall"]);
    body.says("free to move", 1);
    assert!(daemon.leave().success() && body.leave().success());
}

#[test]
fn sockets_and_segments_are_for_the_same_user_only() {
    let stage = Scene::new("modes");
    let _body = stage.body("hall");
    let _daemon = stage.daemon("modes", &["--body", "hall"]);
    let _wander = stage.wander("modes");
    wait_for("wander is attached", || stage.has_layer("modes", "wander"));
    let files = stage.files();
    assert!(files.len() > 8, "{files:?}");
    for file in files {
        let mode = std::fs::metadata(&file).map(|m| m.permissions().mode() & 0o077);
        // Files come and go while the processes live.
        assert!(
            mode.as_ref().map_or(true, |mode| *mode == 0),
            "{}: {mode:?}",
            file.display()
        );
    }
}
