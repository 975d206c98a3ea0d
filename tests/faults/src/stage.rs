//! The stage on which real processes are tried: a domain and a run directory of its own for every injection,
//! and nobody left on it when it is dropped.
//!
//! Must never wait for ever, nor touch a process or a file that is not this stage's.

use std::io::{BufRead, BufReader};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use ipc::control::{Connection, Event, Reply, Request, Versions};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

/// How long something may take before an injection is given up: no criterion, a way out of a hang.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

/// How long a process of a stage lives at most: it ends by itself should nobody be left to end it.
pub(crate) const LIFE_S: &str = "90";

/// Name of the creature of every stage.
pub(crate) const CREATURE: &str = "tried";

/// Name of its body, where that is a process of its own.
pub(crate) const BODY: &str = "hall";

/// The domain and the run directory of one injection.
#[derive(Debug)]
pub(crate) struct Stage {
    pub(crate) domain: String,
    pub(crate) run: PathBuf,
    owner: bool,
}

impl Stage {
    /// A new stage, removed with everything on it when it is dropped.
    pub(crate) fn new(number: usize) -> Result<Stage, String> {
        let domain = format!("faults{}n{number}", std::process::id());
        let run = std::env::temp_dir().join(format!("subsumed-{domain}"));
        std::fs::create_dir_all(&run).map_err(|e| format!("{}: {e}", run.display()))?;
        Ok(Stage {
            domain,
            run,
            owner: true,
        })
    }

    /// The stage that this process was started on.
    pub(crate) fn inherited() -> Result<Stage, String> {
        let domain = std::env::var("SUBSUMED_DOMAIN").map_err(|e| format!("SUBSUMED_DOMAIN: {e}"))?;
        let run = std::env::var_os("SUBSUMED_RUN").ok_or("SUBSUMED_RUN is not set")?;
        Ok(Stage {
            domain,
            run: run.into(),
            owner: false,
        })
    }

    /// A command on this stage.
    pub(crate) fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command
            .env("SUBSUMED_DOMAIN", &self.domain)
            .env("SUBSUMED_RUN", &self.run)
            .stdin(Stdio::null());
        command
    }

    /// Starts a program on this stage.
    pub(crate) fn start(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Result<Player, String> {
        let mut child = self
            .command(program.as_ref())
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{} does not start: {e}", program.as_ref().display()))?;
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = said.clone();
        let errors = child.stderr.take().ok_or("standard error was not piped")?;
        std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                heard.lock().expect("nobody panics holding it").push(line);
            }
        });
        Ok(Player { child, said })
    }

    /// The creature's control socket.
    pub(crate) fn socket(&self) -> PathBuf {
        self.run.join(format!("{}.{CREATURE}.sock", self.domain))
    }

    /// A connection to the daemon that has said hello; none if nobody answers.
    pub(crate) fn connect(&self) -> Option<Connection> {
        let stream = UnixStream::connect(self.socket()).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).ok()?;
        let mut connection = Connection::over(stream).ok()?;
        let hello = Request::Hello {
            versions: Versions::ours(),
            program: "faults".into(),
        };
        connection.ask(&hello).ok()?;
        Some(connection)
    }

    /// One question on a connection of its own; none if nobody answers.
    pub(crate) fn ask(&self, request: &Request) -> Option<Reply> {
        self.connect()?.ask(request).ok()
    }

    /// The daemon's status; null if nobody answers.
    pub(crate) fn status(&self) -> Value {
        match self.ask(&Request::Status) {
            Some(Reply::Status(status)) => status,
            _ => Value::Null,
        }
    }

    /// Whether nothing but everyday reflexes halts the body, which is there.
    pub(crate) fn is_free(&self) -> bool {
        let halt = &self.status()["halt"];
        let reflex = halt["causes"]
            .as_array()
            .is_some_and(|c| c.len() == 1 && c[0] == "reflex");
        halt["halted"] == false || reflex
    }

    /// Whether an event's text holds all of `parts`.
    pub(crate) fn happened(&self, parts: &[&str]) -> bool {
        let Some(Reply::Events(events)) = self.ask(&Request::Events { after: 0 }) else {
            return false;
        };
        let holds = |e: &Event| parts.iter().all(|part| e.text.contains(part));
        events.iter().any(holds)
    }

    /// Whether a layer is attached.
    pub(crate) fn has_layer(&self, layer: &str) -> bool {
        let status = self.status();
        let mut layers = status["layers"].as_array().into_iter().flatten();
        layers.any(|l| l["name"] == layer && l["attached"] == true)
    }

    /// Every file that this stage's processes have in shared memory, in iceoryx2's directory and in the run
    /// directory.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let prefix = format!("iox2_{}_", self.domain);
        let mut found: Vec<PathBuf> = std::fs::read_dir("/dev/shm")
            .into_iter()
            .flatten()
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
        if !self.owner {
            return;
        }
        for file in self.files() {
            let _ = std::fs::remove_file(file);
        }
        let _ = std::fs::remove_dir_all(&self.run);
        let _ = std::fs::remove_dir_all(self.iceoryx());
    }
}

/// A process on the stage; killed at the latest when it is dropped.
#[derive(Debug)]
pub(crate) struct Player {
    child: Child,
    said: Arc<Mutex<Vec<String>>>,
}

impl Player {
    pub(crate) fn signal(&self, signal: Signal) {
        let _ = kill_process(Pid::from_child(&self.child), signal);
    }

    /// Sends `signal`, which ends it, and waits for the end.
    pub(crate) fn end_by(&mut self, signal: Signal) -> Result<ExitStatus, String> {
        self.signal(signal);
        self.end()
    }

    /// Sends SIGTERM; expects it to leave in good order.
    pub(crate) fn leave(&mut self) -> Result<(), String> {
        let status = self.end_by(Signal::TERM)?;
        match status.success() {
            true => Ok(()),
            false => Err(format!(
                "after SIGTERM: {status}, expected 0; it said {:?}",
                self.said()
            )),
        }
    }

    /// Waits for the end.
    pub(crate) fn end(&mut self) -> Result<ExitStatus, String> {
        let mut status = None;
        wait_for("the process ends", || {
            status = self.child.try_wait().ok().flatten();
            status.is_some()
        })?;
        status.ok_or_else(|| "the process did not end".into())
    }

    /// What it said so far on its standard error.
    pub(crate) fn said(&self) -> Vec<String> {
        self.said.lock().expect("nobody panics holding it").clone()
    }

    /// The number that follows `what` in the first line that begins so.
    pub(crate) fn number_after(&self, what: &str) -> Option<u64> {
        let said = self.said();
        said.iter()
            .find_map(|l| l.strip_prefix(what)?.trim().parse().ok())
    }

    /// Waits until it has said a line that holds `what`.
    pub(crate) fn says(&self, what: &str) -> Result<(), String> {
        wait_for(&format!("{what:?} is said"), || {
            self.said().iter().any(|l| l.contains(what))
        })
        .map_err(|e| format!("{e}; so far {:?}", self.said()))
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Waits until `there`.
///
/// # Errors
/// When that takes too long.
pub(crate) fn wait_for(what: &str, mut there: impl FnMut() -> bool) -> Result<(), String> {
    let began = Instant::now();
    while !there() {
        if began.elapsed() > PATIENCE {
            return Err(format!("given up waiting until {what}"));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}
