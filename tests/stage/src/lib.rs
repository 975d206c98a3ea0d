//! The stage: where real processes are tried, with a domain and a run directory of their own, and nobody left on
//! it when it is dropped.
//!
//! Must never wait for ever, nor touch a process or a file that is not this stage's.

mod announcement;
mod player;

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use ipc::control::{Connection, Event, Reply, Request, Versions};
use serde_json::Value;

pub use announcement::announcement;
pub use player::Player;

/// How long something may take before a trial is given up: no criterion, a way out of a hang.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// The domain and the run directory of one trial.
#[derive(Debug)]
pub struct Stage {
    /// Its domain: what `SUBSUMED_DOMAIN` says to the processes on it.
    pub domain: String,
    /// Its run directory: what `SUBSUMED_RUN` says.
    pub run: PathBuf,
    /// Whether this value made it, and removes it.
    owner: bool,
}

impl Stage {
    /// A new stage of that name, which no other has at the same time; removed with all that lies on it when it is
    /// dropped.
    ///
    /// # Errors
    /// When its run directory cannot be made.
    pub fn new(domain: &str) -> Result<Stage, String> {
        let run = std::env::temp_dir().join(format!("subsumed-{domain}"));
        std::fs::create_dir_all(&run).map_err(|e| format!("{}: {e}", run.display()))?;
        Ok(Stage {
            domain: domain.into(),
            run,
            owner: true,
        })
    }

    /// The stage that this process was started on; `None` if it was not.
    pub fn inherited() -> Option<Stage> {
        Some(Stage {
            domain: std::env::var("SUBSUMED_DOMAIN").ok()?,
            run: std::env::var_os("SUBSUMED_RUN")?.into(),
            owner: false,
        })
    }

    /// A command on this stage. What a daemon keeps of its halts stays on the stage too.
    pub fn command(&self, program: impl AsRef<Path>) -> Command {
        let mut command = Command::new(program.as_ref());
        command
            .env("SUBSUMED_DOMAIN", &self.domain)
            .env("SUBSUMED_RUN", &self.run)
            .env("XDG_STATE_HOME", &self.run)
            .env_remove("STATE_DIRECTORY")
            .stdin(Stdio::null());
        command
    }

    /// Starts a program on this stage.
    ///
    /// # Errors
    /// When it does not start.
    pub fn start(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Result<Player, String> {
        self.start_with(program, arguments, &[])
    }

    /// The same with further variables.
    ///
    /// # Errors
    /// When it does not start.
    pub fn start_with(
        &self,
        program: impl AsRef<Path>,
        arguments: &[&str],
        variables: &[(&str, &str)],
    ) -> Result<Player, String> {
        let mut command = self.command(program);
        command.args(arguments).envs(variables.iter().copied());
        Player::start(command)
    }

    /// The control socket of a creature.
    pub fn socket(&self, creature: &str) -> PathBuf {
        self.run.join(format!("{}.{creature}.sock", self.domain))
    }

    /// A connection to a daemon that has said hello; none if nobody answers.
    pub fn connect(&self, creature: &str) -> Option<Connection> {
        let stream = UnixStream::connect(self.socket(creature)).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).ok()?;
        let mut connection = Connection::over(stream).ok()?;
        let hello = Request::Hello {
            versions: Versions::ours(),
            program: "stage".into(),
        };
        connection.ask(&hello).ok()?;
        Some(connection)
    }

    /// One question on a connection of its own; none if nobody answers.
    pub fn ask(&self, creature: &str, request: &Request) -> Option<Reply> {
        self.connect(creature)?.ask(request).ok()
    }

    /// A daemon's status; null if nobody answers.
    pub fn status(&self, creature: &str) -> Value {
        match self.ask(creature, &Request::Status) {
            Some(Reply::Status(status)) => status,
            _ => Value::Null,
        }
    }

    /// Why the body is halted, by the daemon's status.
    pub fn causes(&self, creature: &str) -> Vec<String> {
        causes_in(&self.status(creature))
    }

    /// Whether the daemon answers and nothing but everyday reflexes halts the body.
    pub fn is_free(&self, creature: &str) -> bool {
        let status = self.status(creature);
        status["halt"]["halted"] == false || causes_in(&status) == ["reflex"]
    }

    /// What a daemon noted; nothing if nobody answers.
    pub fn events(&self, creature: &str) -> Vec<Event> {
        match self.ask(creature, &Request::Events { after: 0 }) {
            Some(Reply::Events(events)) => events,
            _ => Vec::new(),
        }
    }

    /// Whether an event's text holds all of `parts`.
    pub fn happened(&self, creature: &str, parts: &[&str]) -> bool {
        let holds = |e: &Event| parts.iter().all(|part| e.text.contains(part));
        self.events(creature).iter().any(holds)
    }

    /// Whether a layer is attached.
    pub fn has_layer(&self, creature: &str, layer: &str) -> bool {
        let status = self.status(creature);
        let mut layers = status["layers"].as_array().into_iter().flatten();
        layers.any(|l| l["name"] == layer && l["attached"] == true)
    }

    /// Every file that this stage's processes have in shared memory, in iceoryx2's directory and in the run
    /// directory; not what they keep of halts on purpose.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut found = self.segments();
        collect(&self.iceoryx(), &mut found);
        collect(&self.run, &mut found);
        let kept = self.run.join("subsumed");
        found.retain(|file| !file.starts_with(&kept));
        found.sort();
        found
    }

    /// The files of this stage in shared memory.
    pub fn segments(&self) -> Vec<PathBuf> {
        let prefix = format!("iox2_{}_", self.domain);
        let files = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
        files
            .filter(|e| e.file_name().to_string_lossy().starts_with(&prefix))
            .map(|e| e.path())
            .collect()
    }

    fn iceoryx(&self) -> PathBuf {
        PathBuf::from(format!("/tmp/iceoryx2-{}", self.domain))
    }
}

fn causes_in(status: &Value) -> Vec<String> {
    let causes = status["halt"]["causes"].as_array().into_iter().flatten();
    causes.filter_map(|c| c.as_str().map(Into::into)).collect()
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

/// Waits until `there`.
///
/// # Errors
/// When that takes too long.
pub fn wait_for(what: &str, mut there: impl FnMut() -> bool) -> Result<(), String> {
    let began = Instant::now();
    while !there() {
        if began.elapsed() > PATIENCE {
            return Err(format!("given up waiting until {what}"));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(name: &str) -> Stage {
        Stage::new(&format!("{name}{}", std::process::id())).expect("a directory")
    }

    #[test]
    fn what_is_left_is_seen_what_is_kept_is_not_and_all_of_it_goes_with_the_stage() {
        let stage = stage("left");
        let run = stage.run.clone();
        std::fs::create_dir(run.join("subsumed")).expect("a directory");
        for file in ["subsumed/kept.mcap", "left.sock"] {
            std::fs::write(run.join(file), "").expect("a file");
        }
        assert_eq!(stage.files(), [run.join("left.sock")]);
        drop(stage);
        assert!(!run.exists());
    }

    #[test]
    fn a_process_is_on_the_stage_keeps_its_halts_there_and_ends_with_its_player() {
        let stage = stage("player");
        let script = "echo $SUBSUMED_DOMAIN $XDG_STATE_HOME ${STATE_DIRECTORY-none} >&2; echo number 7 >&2; \
                      exec sleep 60";
        let mut command = stage.command("sh");
        command.args(["-c", script]).env_remove("STATE_DIRECTORY");
        let mut player = Player::start(command).expect("a shell");
        player.says("number", 1).expect("it speaks");
        let said = format!("{} {} none", stage.domain, stage.run.display());
        assert_eq!(player.said()[0], said);
        assert_eq!(player.number_after("number "), Some(7));
        let told = player.leave().expect_err("a signal is no good order");
        assert!(told.contains("signal: 15"), "{told}");
        assert!(stage.ask("nobody", &Request::Status).is_none() && !stage.is_free("nobody"));
    }
}
