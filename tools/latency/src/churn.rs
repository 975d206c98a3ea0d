//! Churn: readers and tapping layers that attach, leave and are killed while the creature lives.
//!
//! ```text
//!   every 300 ms, in turn:  a reader comes · a tapper comes · the reader is killed · the tapper is killed
//!                           a reader comes · a tapper comes · the reader leaves    · the tapper leaves
//! ```
//! Must never touch the measured processor: those who come and go are bound to another one where there is one.

use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::Source;

use crate::load::CHURN_EVERY;
use crate::modules;

/// The name under which this program is started to be a tapping layer.
pub const TAPPER: &str = "subsumed-lab-tapper";

/// The name under which this program is started to be a reader.
pub const READER: &str = "subsumed-lab-reader";

/// The variable that names the processor of whoever is started.
pub(crate) const CPU: &str = "SUBSUMED_LAB_CPU";

/// Longest that a reader reads, whatever happens to its parent.
const READER_MAX: Duration = Duration::from_secs(10);

/// Events until everybody who came is gone again.
pub const EVENTS: u32 = 4;

/// Those who come and go.
#[derive(Debug)]
pub struct Churn {
    creature: String,
    cpu: usize,
    turn: u64,
    next: Instant,
    reader: Option<Child>,
    tapper: Option<Child>,
}

impl Churn {
    /// Nobody there yet; `cpu` is where they run.
    pub fn new(creature: &str, cpu: usize) -> Churn {
        Churn {
            creature: creature.into(),
            cpu,
            turn: 0,
            next: Instant::now(),
            reader: None,
            tapper: None,
        }
    }

    /// Does what is due; to be called many times a second.
    ///
    /// # Errors
    /// When a process cannot be started.
    pub fn tick(&mut self) -> std::io::Result<()> {
        if Instant::now() < self.next {
            return Ok(());
        }
        self.next += Duration::from_nanos(CHURN_EVERY.0);
        let kill = (self.turn / 4).is_multiple_of(2);
        match self.turn % 4 {
            0 => self.reader = Some(self.start(READER)?),
            1 => self.tapper = Some(self.start(TAPPER)?),
            2 => end(self.reader.take(), kill),
            _ => end(self.tapper.take(), kill),
        }
        self.turn += 1;
        Ok(())
    }

    /// How many came, left or were killed so far.
    pub fn events(&self) -> u64 {
        self.turn
    }

    fn start(&self, name: &str) -> std::io::Result<Child> {
        let cpu = self.cpu.to_string();
        Command::new(std::env::current_exe()?)
            .arg0(name)
            .args(["--creature", &self.creature, "--once"])
            .env(CPU, cpu)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
    }
}

/// Ends a process: by SIGKILL, or as a user would.
fn end(child: Option<Child>, kill: bool) {
    let Some(mut child) = child else { return };
    if kill {
        let _ = child.kill();
    } else if let Some(pid) = rustix::process::Pid::from_raw(child.id() as i32) {
        let _ = rustix::process::kill_process(pid, rustix::process::Signal::TERM);
        let limit = Instant::now() + Duration::from_millis(250);
        while Instant::now() < limit && matches!(child.try_wait(), Ok(None)) {
            std::thread::sleep(Duration::from_millis(2));
        }
        let _ = child.kill();
    }
    let _ = child.wait();
}

impl Drop for Churn {
    fn drop(&mut self) {
        end(self.reader.take(), true);
        end(self.tapper.take(), true);
    }
}

/// Stays where the lab wants it, and no longer than the lab.
pub(crate) fn settle() {
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
    let cpu = std::env::var(CPU).ok().and_then(|c| c.parse().ok());
    if let Some(cpu) = cpu {
        let _ = daemon::executor::host::bind(cpu);
    }
}

/// A layer that taps: what a process started as [`TAPPER`] does.
pub fn tap() -> ExitCode {
    settle();
    afsm::process::run(
        Source::new("tapper.toml (built in)", include_str!("tapper.toml")),
        modules::kinds(),
    )
}

/// A reader: what a process started as [`READER`] does, given its arguments. It reads every wire over and over.
pub fn read(arguments: &[String]) -> ExitCode {
    settle();
    let Some(creature) = arguments.get(1) else {
        return ExitCode::from(2);
    };
    let leave = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    if signal_hook::flag::register(signal_hook::consts::SIGTERM, leave.clone()).is_err() {
        return ExitCode::FAILURE;
    }
    let Ok(domain) = Domain::join(&format!("reader{}", std::process::id())) else {
        return ExitCode::FAILURE;
    };
    let Ok(page) = domain.map(creature) else {
        return ExitCode::FAILURE;
    };
    let readers: Vec<_> = (0..page.len())
        .filter_map(|i| page.reader(i, Kind::Number))
        .collect();
    let end = Instant::now() + READER_MAX;
    while Instant::now() < end && !leave.load(std::sync::atomic::Ordering::Relaxed) {
        for _ in 0..1_000 {
            for reader in &readers {
                std::hint::black_box(reader.read());
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    ExitCode::SUCCESS
}
