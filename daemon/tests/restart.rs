//! Starting again after SIGKILL, with layers attached: at once, the layers come back by themselves, and nothing
//! of the dead remains. Two daemons side by side see nothing of each other.

mod scene;

use std::path::PathBuf;

use ipc::control::{Reply, Request};
use scene::{Scene, wait_for};

#[test]
fn after_sigkill_the_next_start_works_and_attached_layers_come_back() {
    let stage = Scene::new("again");
    let mut daemon = stage.daemon("again", &[]);
    let mut wander = stage.wander("again");
    wait_for("wander is attached", || stage.has_layer("again", "wander"));
    let before = stage.files();
    daemon.kill();
    let mut daemon = stage.daemon("again", &[]);
    let killed = std::time::Instant::now();
    wait_for("wander is attached again", || stage.has_layer("again", "wander"));
    println!(
        "wander came back {:?} after the daemon answered",
        killed.elapsed()
    );
    wait_for("the body is free", || stage.is_free("again"));
    // Names of nodes, ports and segments are drawn anew at every start; only what both instances share by
    // name is in both lists: the service, its settings, the socket.
    let dead: Vec<PathBuf> = before.into_iter().filter(|f| f.exists()).collect();
    for file in &dead {
        let name = file.to_string_lossy();
        let shared = [".service", ".sock", ".dynamic", "global_mgmt"];
        let living = name.contains(&format!("{}", wander.pid()));
        assert!(
            living || shared.iter().any(|s| name.ends_with(s)) || of_wander(&name, &stage),
            "left: {name}"
        );
    }
    assert!(wander.leave().success());
    assert!(daemon.leave().success());
    assert_eq!(stage.files(), Vec::<PathBuf>::new());
}

/// Whether a file belongs to a node that lives: iceoryx2 keeps a directory for each.
fn of_wander(file: &str, stage: &Scene) -> bool {
    let nodes = format!("/tmp/iceoryx2-{}/nodes", stage.domain);
    file.starts_with(&nodes)
}

#[test]
fn two_daemons_side_by_side_have_wires_of_their_own() {
    let stage = Scene::new("pair");
    let mut tom = stage.daemon("tom", &["--seed", "1"]);
    let mut jerry = stage.daemon("jerry", &["--seed", "2"]);
    let mut wander = stage.wander("tom");
    wait_for("wander is attached to tom", || stage.has_layer("tom", "wander"));
    assert!(!stage.has_layer("jerry", "wander"));
    let Some(Reply::Directory(directory)) = stage.ask("jerry", &Request::Directory) else {
        panic!("jerry shows no directory")
    };
    assert!(directory.outputs.iter().all(|o| o.owner == "jerry"));
    // A halt of one is none of the other's business, nor is its death.
    assert_eq!(stage.ask("tom", &Request::Halt), Some(Reply::Done));
    wait_for("tom is halted", || stage.causes("tom") == ["emergency stop"]);
    // On a busy host a late beat may halt it for a moment, but not for tom's reason.
    assert!(!stage.causes("jerry").iter().any(|c| c == "emergency stop"));
    wait_for("jerry may move", || stage.is_free("jerry"));
    tom.kill();
    let messages = || {
        stage.status("jerry")["wires"][1]["messages"]
            .as_u64()
            .expect("a count")
    };
    let first = messages();
    wait_for("jerry's wires go on", || messages() > first + 10);
    wait_for("jerry may move, with tom dead", || stage.is_free("jerry"));
    let mut third = stage.start(env!("CARGO_BIN_EXE_subsumed"), &["--name", "jerry", "--headless"]);
    assert_eq!(
        third.end().code(),
        Some(1),
        "a second daemon of one name is refused"
    );
    wander.kill();
    assert!(jerry.leave().success());
    // Jerry cleans up after the dead; tom's socket alone waits for the next tom.
    assert_eq!(stage.files(), [stage.socket("tom")]);
}
