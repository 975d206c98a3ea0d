//! Who is fed while all is well: systemd's watchdog, and a device that a plain file stands in for.

mod scene;

use std::os::unix::net::UnixDatagram;
use std::time::Duration;

use rustix::process::Signal;
use scene::{Scene, wait_for};

/// A creature file with a watchdog device.
fn with_device(stage: &Scene, device: &str) -> String {
    let text = allen::CREATURE.replace("[halt]\n", &format!("[halt]\nwatchdog_device = \"{device}\"\n"));
    assert_ne!(text, allen::CREATURE, "allen.toml has a [halt] of its own line");
    let path = stage.run.join("fed.toml");
    std::fs::write(&path, text).expect("a creature file");
    path.to_string_lossy().into_owned()
}

#[test]
fn systemd_hears_ready_meals_while_all_beat_and_stopping() {
    let stage = Scene::new("systemd");
    let path = stage.run.join("notify");
    let socket = UnixDatagram::bind(&path).expect("a socket for the test");
    let heard = |wait: Duration| {
        socket
            .set_read_timeout(Some(wait))
            .expect("a socket takes a time-out");
        let mut bytes = [0; 4096];
        let n = socket.recv(&mut bytes).ok()?;
        Some(String::from_utf8_lossy(&bytes[..n]).into_owned())
    };
    let long = Duration::from_secs(30);
    let arguments = ["--name", "fed", "--headless", "--seconds", "120"];
    let variables = [
        ("NOTIFY_SOCKET", path.to_str().expect("a plain path")),
        ("WATCHDOG_USEC", "400000"),
    ];
    let mut daemon = stage.start_with(env!("CARGO_BIN_EXE_subsumed"), &arguments, &variables);
    let first = heard(long).expect("it says that it is ready");
    let status = "STATUS=level 0 (avoid); ";
    assert!(first.contains("READY=1") && first.contains(status), "{first}");
    for _ in 0..5 {
        assert!(heard(long).is_some_and(|said| said.contains("WATCHDOG=1")));
    }
    daemon.signal(Signal::STOP);
    // What was under way when it froze; then silence.
    while heard(Duration::from_secs(1)).is_some() {}
    assert_eq!(heard(Duration::from_secs(2)), None);
    daemon.signal(Signal::CONT);
    assert!(
        heard(long).is_some_and(|said| said.contains("WATCHDOG=1")),
        "fed again"
    );
    daemon.signal(Signal::HUP);
    while !heard(long).expect("a reload is said").contains("RELOADING=1") {}
    while !heard(long).expect("and its end").contains("READY=1") {}
    daemon.says("reload: the creature file is sound, and says what runs", 1);
    assert!(daemon.leave().success());
    let mut all = Vec::new();
    while let Some(said) = heard(Duration::from_millis(200)) {
        all.push(said);
    }
    let halted = all.iter().position(|said| said.contains("halted: shutdown"));
    let stopping = all.iter().position(|said| said.contains("STOPPING=1"));
    assert!(stopping.is_some() && stopping < halted, "{all:?}");
    let last = all.pop().expect("it was not silent");
    assert!(
        last.contains("STOPPING=1") && last.contains("the body stands"),
        "{last}"
    );
}

#[test]
fn a_device_is_fed_and_bidden_farewell_only_after_an_orderly_halt() {
    let stage = Scene::new("device");
    let device = stage.run.join("watchdog");
    std::fs::write(&device, "").expect("a stand-in");
    let creature = with_device(&stage, &device.to_string_lossy());
    let eaten = || std::fs::read_to_string(&device).expect("the stand-in is there");
    let mut daemon = stage.daemon("fed", &["--creature", &creature]);
    wait_for("it is fed", || eaten().len() > 3);
    assert!(daemon.leave().success());
    assert!(
        eaten().ends_with(".V") && eaten().matches('V').count() == 1,
        "{}",
        eaten()
    );
    std::fs::write(&device, "").expect("a stand-in");
    let mut daemon = stage.daemon("fed", &["--creature", &creature]);
    wait_for("it is fed", || eaten().len() > 3);
    daemon.kill();
    assert!(
        !eaten().contains('V'),
        "a killed daemon must leave the device to bite"
    );
}

#[test]
fn a_device_that_cannot_be_fed_refuses_the_start() {
    let stage = Scene::new("nodevice");
    let creature = with_device(&stage, "/nowhere/watchdog");
    let mut daemon = stage.start(
        env!("CARGO_BIN_EXE_subsumed"),
        &["--creature", &creature, "--headless"],
    );
    assert_eq!(daemon.end().code(), Some(1));
    daemon.says("the watchdog device /nowhere/watchdog cannot be written", 1);
    let creature = with_device(&stage, "watchdog");
    let mut daemon = stage.start(
        env!("CARGO_BIN_EXE_subsumed"),
        &["--creature", &creature, "--headless"],
    );
    assert_eq!(daemon.end().code(), Some(2));
    daemon.says("\"watchdog\" is not an absolute path", 1);
}
