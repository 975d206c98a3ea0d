//! What callers and layers may not do to a daemon: hold others up, take its memory, flood it, or come in as
//! somebody else. Each is tried with real connections and pages.

mod scene;

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock::{self, Span};
use ipc::control::{Connection, Plug, REQUEST_MAX, Reply, Request, Versions};
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::Writer;
use ipc::wire::iceoryx::{Domain, OwnedPage};
use scene::{Scene, on_stage, wait_for};
use stage::announcement;

/// A layer that shares one wire and taps `turn.heading` with it, beating whatever way its test wants.
struct Layer {
    connection: Connection,
    writer: Option<Writer>,
    leave: Arc<AtomicBool>,
}

impl Layer {
    fn plug(stage: &Scene, creature: &str, name: &str) -> Result<Layer, String> {
        let domain = Domain::join(name).map_err(|e| e.to_string())?;
        let owner = format!("{creature}/{name}");
        let owned = domain.own(&owner, 1).map_err(|e| e.to_string())?;
        let writer = owned.page().writer(0, Kind::Polar);
        let leave = Arc::new(AtomicBool::new(false));
        serve(owned, domain, leave.clone());
        let stream = UnixStream::connect(stage.socket(creature)).expect("the daemon listens");
        let mut connection = Connection::over(stream).expect("a socket can be cloned");
        let hello = Request::Hello {
            versions: Versions::ours(),
            program: "tester".into(),
        };
        connection.ask(&hello).expect("the daemon answers");
        // Whatever process it claims to be, the one that speaks counts.
        let plug = Plug {
            pid: 1,
            ..announcement(creature, name, Span::millis(20), Span::secs(1))
        };
        match connection.ask(&Request::Plug(plug)).expect("the daemon answers") {
            Reply::Plugged { .. } => Ok(Layer {
                connection,
                writer,
                leave,
            }),
            Reply::Refused { reasons } => {
                leave.store(true, Ordering::Relaxed);
                Err(reasons.join("; "))
            }
            other => panic!("a plug was answered with {other:?}"),
        }
    }

    /// Whether the daemon has closed the connection.
    fn is_dismissed(&mut self) -> bool {
        matches!(self.connection.receive::<Reply>(), Ok(None) | Err(_))
    }
}

impl Drop for Layer {
    fn drop(&mut self) {
        self.leave.store(true, Ordering::Relaxed);
    }
}

fn serve(owned: OwnedPage, domain: Domain, leave: Arc<AtomicBool>) {
    std::thread::spawn(move || {
        while !leave.load(Ordering::Relaxed) {
            owned.serve();
            std::thread::sleep(Duration::from_millis(2));
        }
        drop(owned);
        domain.leave();
    });
}

#[test]
fn a_layer_that_floods_is_let_go_and_kept_out() {
    let Some(stage) = on_stage("a_layer_that_floods_is_let_go_and_kept_out", "flood") else {
        return;
    };
    let mut daemon = stage.daemon("flooded", &[]);
    let mut layer = Layer::plug(&stage, "flooded", "flood").expect("a sound layer is attached");
    let mut writer = layer.writer.take().expect("its own wire");
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = stop.clone();
    let pour = std::thread::spawn(move || {
        while !stopped.load(Ordering::Relaxed) {
            writer.write(clock::monotonic(), &[0.5; WORDS_MAX]);
        }
    });
    assert!(layer.is_dismissed());
    stop.store(true, Ordering::Relaxed);
    pour.join().expect("it only writes");
    wait_for("the breach is told", || {
        stage.happened("flooded", &["policy breach: layer flood floods"])
    });
    // By the process that the kernel names, not the one the layer claims to be.
    let own = format!("layer flood (pid {}) was let go", std::process::id());
    wait_for("it was let go", || stage.happened("flooded", &[&own]));
    drop(layer);
    let refusal = Layer::plug(&stage, "flooded", "flood")
        .err()
        .expect("it is kept out");
    assert!(refusal.contains("broke the policy"), "{refusal}");
    assert!(Layer::plug(&stage, "flooded", "other").is_ok());
    wait_for("the body is free", || stage.is_free("flooded"));
    assert!(daemon.leave().success());
}

#[test]
fn garbage_on_a_tap_is_named_and_does_nothing() {
    let Some(stage) = on_stage("garbage_on_a_tap_is_named_and_does_nothing", "garbage") else {
        return;
    };
    let mut daemon = stage.daemon("spoilt", &[]);
    let mut layer = Layer::plug(&stage, "spoilt", "garbage").expect("a sound layer is attached");
    let writer = layer.writer.as_mut().expect("its own wire");
    let tap = || {
        let taps = stage.status("spoilt")["taps"].clone();
        taps.as_array()
            .into_iter()
            .flatten()
            .find(|t| t["from"] == "garbage.heading")
            .cloned()
    };
    wait_for("the tap is shown", || tap().is_some());
    let tap = || tap().expect("the layer stays attached");
    let faults = || tap()["faults"].as_u64().expect("a count");
    for (ahead, value) in [
        (Span::ZERO, f64::NAN),
        (Span::ZERO, f64::INFINITY),
        (Span::secs(3600), 0.5),
    ] {
        let before = faults();
        // What is written before the layer below has taken up the tap is not heard: it is written again.
        wait_for("it is counted", || {
            writer.write(clock::monotonic() + ahead, &[value; WORDS_MAX]);
            std::thread::sleep(Duration::from_millis(50));
            faults() > before
        });
    }
    wait_for("it is named", || {
        stage.happened("spoilt", &["layer garbage", "messages that were none"])
    });
    assert_eq!(tap()["delivered"], 0);
    drop(layer);
    wait_for("its end is told", || {
        stage.happened("spoilt", &["layer garbage", "died"])
    });
    assert!(daemon.leave().success());
}

#[test]
fn callers_that_drip_or_say_nothing_hold_nobody_up() {
    let stage = Scene::new("loris");
    let mut daemon = stage.daemon("patient", &[]);
    let mut silent = Vec::new();
    for round in 0..100 {
        let mut stream = UnixStream::connect(stage.socket("patient")).expect("the daemon listens");
        if round % 2 == 0 {
            let _ = stream.write_all(b"{\"ask\":");
        }
        silent.push(stream);
    }
    // More of them than there are places, and a tool is answered all the same.
    for _ in 0..20 {
        assert!(stage.ask("patient", &Request::Status).is_some());
    }
    // A line that never ends is given up, however steadily it drips.
    let mut drip = UnixStream::connect(stage.socket("patient")).expect("the daemon listens");
    let mut reader = BufReader::new(drip.try_clone().expect("a socket can be cloned"));
    while drip.write_all(b"[").is_ok() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let mut line = String::new();
    let _ = reader.read_line(&mut line);
    assert!(line.contains("a line without an end"), "{line}");
    assert!(daemon.leave().success());
}

#[test]
fn a_request_takes_a_bounded_share_of_memory() {
    let stage = Scene::new("greedy");
    let mut daemon = stage.daemon("bounded", &[]);
    let mut stream = UnixStream::connect(stage.socket("bounded")).expect("the daemon listens");
    let mut sent = 0;
    while stream.write_all(&[b' '; 4096]).is_ok() && sent < 100 * REQUEST_MAX {
        sent += 4096;
    }
    assert!(sent < 10 * REQUEST_MAX, "{sent} bytes of one line were taken");
    let mut answer = String::new();
    let _ = stream.read_to_string(&mut answer);
    // Nested too deeply, within the length.
    let mut caller = UnixStream::connect(stage.socket("bounded")).expect("the daemon listens");
    caller.write_all(&[b'['; 100_000]).expect("it is read");
    caller.write_all(b"\n").expect("it is read");
    let mut answer = String::new();
    BufReader::new(caller)
        .read_line(&mut answer)
        .expect("it is answered");
    assert!(answer.contains("refused"), "{answer}");
    assert!(stage.ask("bounded", &Request::Status).is_some());
    assert!(daemon.leave().success());
}
