//! The stage on which real processes are tried: a domain and a run directory of its own for every test, and
//! nobody left on it when it is dropped.
#![allow(dead_code)] // each test file uses its part of it

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use ipc::control::{Event, Reply, Request, Versions};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

/// How long something may take before the test is given up: no criterion, a way out of a hang.
const PATIENCE: Duration = Duration::from_secs(60);

/// A test's own domain and run directory.
pub(crate) struct Stage {
    pub(crate) domain: String,
    pub(crate) run: PathBuf,
}

impl Stage {
    pub(crate) fn new(test: &str) -> Stage {
        let domain = format!("{test}{}", std::process::id());
        let run = std::env::temp_dir().join(format!("subsumed-test-{domain}"));
        std::fs::create_dir_all(&run).expect("a directory for the test");
        Stage { domain, run }
    }

    /// Starts a program on this stage.
    pub(crate) fn start(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Player {
        self.start_with(program, arguments, &[])
    }

    /// The same with further variables.
    pub(crate) fn start_with(
        &self,
        program: impl AsRef<Path>,
        arguments: &[&str],
        variables: &[(&str, &str)],
    ) -> Player {
        let mut child = Command::new(program.as_ref())
            .args(arguments)
            .env("SUBSUMED_DOMAIN", &self.domain)
            .env("SUBSUMED_RUN", &self.run)
            .env_remove("STATE_DIRECTORY")
            .env("XDG_STATE_HOME", &self.run)
            .envs(variables.iter().copied())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("{} does not start: {e}", program.as_ref().display()));
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = said.clone();
        let errors = child.stderr.take().expect("it was piped");
        std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                heard.lock().expect("nobody panics holding it").push(line);
            }
        });
        Player { child, said }
    }

    /// A daemon with Allen, level 0; ends by itself after two minutes.
    pub(crate) fn daemon(&self, name: &str, arguments: &[&str]) -> Player {
        let mut all = vec!["--name", name, "--headless", "--seconds", "120"];
        all.extend(arguments);
        let player = self.start(env!("CARGO_BIN_EXE_subsumed"), &all);
        wait_for(&format!("daemon {name} answers"), || {
            self.ask(name, &Request::Status).is_some()
        });
        player
    }

    /// A body process with Allen's office.
    pub(crate) fn body(&self, name: &str) -> Player {
        let program = env!("CARGO_BIN_EXE_subsumed-body");
        self.start(program, &["--name", name, "--seconds", "120"])
    }

    /// Level 1 of Allen as a process.
    pub(crate) fn wander(&self, creature: &str) -> Player {
        let beside = Path::new(env!("CARGO_BIN_EXE_subsumed"))
            .parent()
            .expect("it lies in a directory");
        // As an example of this package, or as the layer's own package builds it.
        let built = [beside.join("examples/wander"), beside.join("allen-wander")];
        let program = built.iter().find(|p| p.exists());
        let program = program.expect("build it first: cargo build -p daemon --example wander");
        self.start(program, &["--creature", creature])
    }

    pub(crate) fn socket(&self, creature: &str) -> PathBuf {
        self.run.join(format!("{}.{creature}.sock", self.domain))
    }

    /// One question on a connection of its own; none if nobody answers.
    pub(crate) fn ask(&self, creature: &str, request: &Request) -> Option<Reply> {
        let stream = std::os::unix::net::UnixStream::connect(self.socket(creature)).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).ok()?;
        let mut connection = ipc::control::Connection::over(stream).ok()?;
        let hello = Request::Hello {
            versions: Versions::ours(),
            program: "tester".into(),
        };
        connection.ask(&hello).ok()?;
        connection.ask(request).ok()
    }

    pub(crate) fn status(&self, creature: &str) -> Value {
        match self.ask(creature, &Request::Status) {
            Some(Reply::Status(status)) => status,
            other => panic!("{creature} answers {other:?} instead of its status"),
        }
    }

    /// Why the body is halted, by the daemon's status.
    pub(crate) fn causes(&self, creature: &str) -> Vec<String> {
        let status = self.status(creature);
        let causes = status["halt"]["causes"].as_array().cloned().unwrap_or_default();
        causes.iter().filter_map(|c| c.as_str().map(Into::into)).collect()
    }

    /// Whether nothing but everyday reflexes halts the body.
    pub(crate) fn is_free(&self, creature: &str) -> bool {
        let status = self.status(creature);
        status["halt"]["halted"] == false || self.causes(creature) == ["reflex"]
    }

    pub(crate) fn events(&self, creature: &str) -> Vec<Event> {
        match self.ask(creature, &Request::Events { after: 0 }) {
            Some(Reply::Events(events)) => events,
            other => panic!("{creature} answers {other:?} instead of its events"),
        }
    }

    /// Whether an event's text holds all of `parts`.
    pub(crate) fn happened(&self, creature: &str, parts: &[&str]) -> bool {
        let holds = |e: &Event| parts.iter().all(|part| e.text.contains(part));
        self.events(creature).iter().any(holds)
    }

    /// Whether a layer is attached.
    pub(crate) fn has_layer(&self, creature: &str, layer: &str) -> bool {
        let status = self.status(creature);
        let layers = status["layers"].as_array().cloned().unwrap_or_default();
        layers.iter().any(|l| l["name"] == layer && l["attached"] == true)
    }

    /// Every file that this stage's processes have in shared memory, in iceoryx2's directory and in the run
    /// directory.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let prefix = format!("iox2_{}_", self.domain);
        let mut found: Vec<PathBuf> = std::fs::read_dir("/dev/shm")
            .expect("there is shared memory")
            .flatten()
            .filter(|e| e.file_name().to_string_lossy().starts_with(&prefix))
            .map(|e| e.path())
            .collect();
        collect(&self.iceoryx(), &mut found);
        collect(&self.run, &mut found);
        found.sort();
        found
    }

    fn iceoryx(&self) -> PathBuf {
        PathBuf::from(format!("/tmp/iceoryx2-{}", self.domain))
    }
}

fn collect(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else {
            found.push(path);
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        for file in self.files() {
            let _ = std::fs::remove_file(file);
        }
        let _ = std::fs::remove_dir_all(&self.run);
        let _ = std::fs::remove_dir_all(self.iceoryx());
    }
}

/// A process on the stage; killed at the latest when it is dropped.
pub(crate) struct Player {
    child: Child,
    said: Arc<Mutex<Vec<String>>>,
}

impl Player {
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    pub(crate) fn signal(&self, signal: Signal) {
        let _ = kill_process(Pid::from_child(&self.child), signal);
    }

    /// Sends SIGKILL and waits for the end.
    pub(crate) fn kill(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Sends SIGTERM and waits for the end.
    pub(crate) fn leave(&mut self) -> ExitStatus {
        self.signal(Signal::TERM);
        self.end()
    }

    /// Waits for the end.
    pub(crate) fn end(&mut self) -> ExitStatus {
        let mut status = None;
        wait_for("the process ends", || {
            status = self.child.try_wait().expect("it is our child");
            status.is_some()
        });
        status.expect("it has ended")
    }

    /// What it said so far on its standard error.
    pub(crate) fn said(&self) -> Vec<String> {
        self.said.lock().expect("nobody panics holding it").clone()
    }

    /// Waits until it has said `what` for the `times`-th time.
    pub(crate) fn says(&self, what: &str, times: usize) {
        let heard = || self.said().iter().filter(|line| line.contains(what)).count() >= times;
        wait_for(
            &format!("{what:?} for the {times}. time, so far: {:#?}", self.said()),
            heard,
        );
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Waits until `there`; a hang ends the test.
pub(crate) fn wait_for(what: &str, mut there: impl FnMut() -> bool) {
    let began = Instant::now();
    while !there() {
        assert!(began.elapsed() < PATIENCE, "given up waiting until {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
