//! What the daemon refuses, tried on a running one: callers of another version, nonsense on the control socket,
//! layers that want more than they may. The daemon goes on in every case.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use ipc::clock::Span;
use ipc::control::{Plug, PlugTap, Reply, Request, Versions};
use ipc::message::Kind;
use ipc::wiring::creature::How;
use ipc::wiring::directory::Listed;

/// A running daemon in a domain of its own; halted and gone when dropped.
struct Daemon {
    child: Child,
    run: PathBuf,
    domain: String,
}

impl Daemon {
    fn start(test: &str) -> Daemon {
        let domain = format!("{test}{}", std::process::id());
        let run = std::env::temp_dir().join(&domain);
        let child = Command::new(env!("CARGO_BIN_EXE_subsumed"))
            .args(["--name", "tried", "--headless", "--seconds", "60"])
            .env("SUBSUMED_DOMAIN", &domain)
            .env("SUBSUMED_RUN", &run)
            .stderr(Stdio::null())
            .spawn()
            .expect("the daemon starts");
        let daemon = Daemon { child, run, domain };
        while UnixStream::connect(daemon.socket()).is_err() {
            std::thread::sleep(Duration::from_millis(20));
        }
        daemon
    }

    fn socket(&self) -> PathBuf {
        self.run.join(format!("{}.tried.sock", self.domain))
    }

    fn call(&self) -> Caller {
        let stream = UnixStream::connect(self.socket()).expect("the daemon listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(20)))
            .expect("a socket takes a time-out");
        Caller {
            reader: BufReader::new(stream.try_clone().expect("a socket can be cloned")),
            stream,
        }
    }

    fn greeted(&self) -> Caller {
        let mut caller = self.call();
        let welcome = caller.ask(&hello(Versions::ours()));
        assert!(matches!(welcome, Some(Reply::Welcome { .. })), "{welcome:?}");
        caller
    }

    /// It answers, and its layers go on beating: the test ends, or hangs and is seen to.
    fn lives(&self) {
        let first = self.beats();
        while self.beats() == first {
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn beats(&self) -> u64 {
        let Some(Reply::Status(status)) = self.greeted().ask(&Request::Status) else {
            panic!("the daemon no longer answers")
        };
        status["layers"][0]["beats"].as_u64().unwrap_or(0)
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let pid = rustix::process::Pid::from_child(&self.child);
        let _ = rustix::process::kill_process(pid, rustix::process::Signal::TERM);
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.run);
        let _ = std::fs::remove_dir_all(format!("/tmp/iceoryx2-{}", self.domain));
    }
}

struct Caller {
    stream: UnixStream,
    reader: BufReader<UnixStream>,
}

impl Caller {
    fn say(&mut self, bytes: &[u8]) -> Option<Reply> {
        self.stream.write_all(bytes).ok()?;
        let mut line = String::new();
        self.reader.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok()
    }

    fn ask(&mut self, request: &Request) -> Option<Reply> {
        let mut line = serde_json::to_vec(request).expect("a request is JSON");
        line.push(b'\n');
        self.say(&line)
    }

    fn refused(&mut self, request: &Request) -> String {
        match self.ask(request) {
            Some(Reply::Refused { reasons }) => reasons.join("; "),
            other => panic!("{request:?} was answered with {other:?}"),
        }
    }
}

fn hello(versions: Versions) -> Request {
    Request::Hello {
        versions,
        program: "tester".into(),
    }
}

/// A layer that would be accepted if only its owner shared its wires.
fn plug() -> Plug {
    Plug {
        layer: "newcomer".into(),
        level: 1,
        period: Span::millis(20),
        pid: std::process::id(),
        owner: "nobody".into(),
        outputs: vec![Listed {
            name: "new.heading".into(),
            kind: Kind::Polar,
            unit: String::new(),
            level: Some(1),
            owner: "nobody".into(),
            index: 0,
            plug: 0,
        }],
        taps: vec![PlugTap {
            how: How::Suppress,
            from: "new.heading".into(),
            to: "turn.heading".into(),
            time_constant: Span::secs(1),
        }],
        ..Plug::default()
    }
}

#[test]
fn callers_of_another_version_are_told_both_versions() {
    let daemon = Daemon::start("version");
    let layout = Versions {
        layout: 999,
        ..Versions::ours()
    };
    let reason = daemon.call().refused(&hello(layout));
    assert!(
        reason.contains("wire layout 999") && reason.contains("wire layout 1"),
        "{reason}"
    );
    let iceoryx2 = Versions {
        iceoryx2: "0.9.9".into(),
        ..Versions::ours()
    };
    let reason = daemon.call().refused(&hello(iceoryx2));
    assert!(
        reason.contains("iceoryx2 0.9.9") && reason.contains("iceoryx2 0.10.0"),
        "{reason}"
    );
    let mut unknown = daemon.call();
    assert!(
        unknown
            .refused(&Request::Plug(plug()))
            .contains("say hello first")
    );
    daemon.lives();
}

#[test]
fn nonsense_on_the_control_socket_is_answered_or_dropped_and_nothing_else() {
    let daemon = Daemon::start("nonsense");
    for nonsense in [
        &b"\n"[..],
        b"{}\n",
        b"[[[[[[\n",
        b"\xff\xfe\x00\n",
        b"{\"ask\":\"status\"\n",
    ] {
        let reply = daemon.call().say(nonsense);
        assert!(
            matches!(reply, Some(Reply::Refused { .. })),
            "{nonsense:?}: {reply:?}"
        );
    }
    // Half a line, then gone; and callers that never say anything.
    daemon
        .call()
        .stream
        .write_all(b"{\"ask\":")
        .expect("the daemon listens");
    let _silent: Vec<Caller> = (0..8).map(|_| daemon.call()).collect();
    daemon.lives();
}

#[test]
fn layers_that_want_more_than_they_may_are_refused_with_every_reason() {
    let daemon = Daemon::start("greedy");
    let refused = |change: &dyn Fn(&mut Plug)| {
        let mut plug = plug();
        change(&mut plug);
        daemon.greeted().refused(&Request::Plug(plug))
    };
    assert!(refused(&|p| p.layer = "avoid".into()).contains("already"));
    assert!(refused(&|p| p.level = 0).contains("not of a level below 0"));
    assert!(refused(&|p| p.taps[0].to = "forward.halt".into()).contains("does not open forward.halt"));
    assert!(refused(&|p| p.taps[0].to = "turn.heding".into()).contains("no such port turn.heding"));
    assert!(refused(&|p| p.taps[0].from = "new.other".into()).contains("not among the layer's outputs"));
    assert!(
        refused(&|p| p.outputs[0].kind = Kind::Number).contains("does not carry what turn.heading takes")
    );
    assert!(refused(&|p| p.taps[0].time_constant = Span::ZERO).contains("needs a time constant"));
    assert!(refused(&|p| p.taps[0].time_constant = Span::secs(3600)).contains("at most 60s"));
    let halt = refused(&|p| {
        p.taps[0].how = How::Inhibit;
        p.taps[0].to = "collide.halt".into();
    });
    assert!(halt.contains("part of the halt channel"), "{halt}");
    // Nothing wrong with what it says, but its wires are nowhere to be found.
    assert!(refused(&|_| ()).contains("no process shares wires as \"nobody\""));
    daemon.lives();
}
