//! A player: a process on the stage, with what it says and how it ends.
//!
//! Must never outlive the value that stands for it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process, waitid};

use crate::wait_for;

/// A process on the stage; killed at the latest when it is dropped.
#[derive(Debug)]
pub struct Player {
    child: Child,
    said: Arc<Mutex<Vec<String>>>,
    listener: Option<JoinHandle<()>>,
}

/// How long the last words of a process may take to be heard, should a child of its own still hold the line.
const LAST_WORDS: Duration = Duration::from_secs(1);

impl Player {
    /// Starts `command`; what it says on standard error is heard.
    ///
    /// # Errors
    /// When it does not start.
    pub fn start(mut command: Command) -> Result<Player, String> {
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        let child = command.spawn();
        let mut child = child.map_err(|e| format!("{:?} does not start: {e}", command.get_program()))?;
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = said.clone();
        let errors = child.stderr.take().ok_or("standard error was not piped")?;
        let listener = std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                heard.lock().expect("nobody panics holding it").push(line);
            }
        });
        let listener = Some(listener);
        Ok(Player {
            child,
            said,
            listener,
        })
    }

    /// Its process id.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Sends it a signal.
    pub fn signal(&self, signal: Signal) {
        let _ = kill_process(Pid::from_child(&self.child), signal);
    }

    /// Freezes it by SIGSTOP, and waits until all of it stands: the first of its threads to hear of it stops the others,
    /// and on a busy host that one may have to wait for its turn.
    ///
    /// # Errors
    /// When it does not stop.
    pub fn freeze(&self) -> Result<(), String> {
        self.signal(Signal::STOP);
        let pid = Pid::from_child(&self.child);
        let looked = WaitIdOptions::STOPPED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        let began = Instant::now();
        while !matches!(waitid(WaitId::Pid(pid), looked), Ok(Some(_))) {
            if began.elapsed() > crate::PATIENCE {
                return Err("given up waiting until the process stands".into());
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        Ok(())
    }

    /// Sends `signal`, which ends it, and waits for the end.
    ///
    /// # Errors
    /// When it does not end.
    pub fn end_by(&mut self, signal: Signal) -> Result<ExitStatus, String> {
        self.signal(signal);
        self.end()
    }

    /// Sends SIGTERM; expects it to leave in good order.
    ///
    /// # Errors
    /// When it does not end, or ends with another status than 0.
    pub fn leave(&mut self) -> Result<(), String> {
        let status = self.end_by(Signal::TERM)?;
        match status.success() {
            true => Ok(()),
            false => Err(format!(
                "after SIGTERM: {status}, expected 0; it said {:?}",
                self.said()
            )),
        }
    }

    /// Whether it has ended.
    pub fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits for the end.
    ///
    /// # Errors
    /// When it does not come.
    pub fn end(&mut self) -> Result<ExitStatus, String> {
        let mut status = None;
        let ended = wait_for("the process ends", || {
            status = self.child.try_wait().ok().flatten();
            status.is_some()
        });
        self.hear_out();
        status.ok_or_else(|| format!("{}; it said {:?}", ended.err().unwrap_or_default(), self.said()))
    }

    /// Waits until all that a process said which has ended is heard.
    fn hear_out(&mut self) {
        let began = Instant::now();
        if let Some(listener) = self.listener.take() {
            while !listener.is_finished() && began.elapsed() < LAST_WORDS {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    }

    /// What it said so far on its standard error.
    pub fn said(&self) -> Vec<String> {
        self.said.lock().expect("nobody panics holding it").clone()
    }

    /// The number that follows `what` in the first line that begins so.
    pub fn number_after(&self, what: &str) -> Option<u64> {
        let said = self.said();
        said.iter()
            .find_map(|l| l.strip_prefix(what)?.trim().parse().ok())
    }

    /// Waits until it has said a line that holds `what` for the `times`-th time.
    ///
    /// # Errors
    /// When it does not, with what it said instead.
    pub fn says(&self, what: &str, times: usize) -> Result<(), String> {
        let heard = || self.said().iter().filter(|line| line.contains(what)).count() >= times;
        let waited = wait_for(&format!("{what:?} is said for the {times}. time"), heard);
        waited.map_err(|e| format!("{e}; so far {:#?}", self.said()))
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
