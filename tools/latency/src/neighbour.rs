//! A neighbour: a creature like the lab's own, alive in a process beside it, for those who come and go to come to.
//!
//! ```text
//!   nobody comes  ·  they come and go at the neighbour: the host's share  ·  at the creature measured: that and ours
//! ```
//! Must never touch the measured processor, nor outlive the lab.

use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use ipc::clock::Span;
use ipc::wiring::creature::Wake;

use crate::churn;
use crate::creature::{Alive, Setting};

/// The name under which this program is started to be one.
pub const NEIGHBOUR: &str = "subsumed-lab-neighbour";

/// How long it may take to end.
const END_MAX: Duration = Duration::from_secs(2);

/// A neighbour that lives until it is dropped.
#[derive(Debug)]
pub struct Neighbour {
    /// Its name, for those who plug in.
    pub name: String,
    child: Child,
    /// It ends when this is closed.
    stdin: Option<ChildStdin>,
}

impl Neighbour {
    /// Starts one on processor `cpu`.
    ///
    /// # Errors
    /// When it does not start, with what it said.
    pub fn start(cpu: usize, period: Span) -> Result<Neighbour, String> {
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let mut command = Command::new(program);
        command.arg0(NEIGHBOUR).arg(period.0.to_string());
        command.env(churn::CPU, cpu.to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        // What it says of its own layers would be taken for what the measured ones say.
        command.stderr(Stdio::null());
        // Ctrl-C is for the lab, which ends it.
        command.process_group(0);
        let mut child = command.spawn().map_err(|e| format!("the neighbour: {e}"))?;
        let out = child.stdout.take().ok_or("its standard output was not piped")?;
        let mut neighbour = Neighbour {
            name: String::new(),
            stdin: child.stdin.take(),
            child,
        };
        let read = BufReader::new(out).read_line(&mut neighbour.name);
        neighbour.name.truncate(neighbour.name.trim_end().len());
        match read {
            Ok(_) if !neighbour.name.is_empty() => Ok(neighbour),
            _ => Err("the neighbour ended before it lived".into()),
        }
    }
}

impl Drop for Neighbour {
    fn drop(&mut self) {
        drop(self.stdin.take());
        let limit = Instant::now() + END_MAX;
        while Instant::now() < limit && matches!(self.child.try_wait(), Ok(None)) {
            std::thread::sleep(Duration::from_millis(5));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What a process started as [`NEIGHBOUR`] does, given its arguments: it lives until its standard input is closed.
pub fn live(arguments: &[String]) -> ExitCode {
    churn::settle();
    let cpu = std::env::var(churn::CPU).ok().and_then(|c| c.parse().ok());
    let period = arguments.first().and_then(|a| a.parse().ok());
    let (Some(cpu), Some(period)) = (cpu, period) else {
        return ExitCode::from(2);
    };
    let alive = Alive::start(&Setting {
        cpu,
        period: Span(period),
        wake: Wake::Sleep,
    });
    match alive {
        Ok(alive) => {
            println!("{}", alive.name);
            let _ = std::io::stdin().read_to_end(&mut Vec::new());
            alive.finish();
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("the neighbour: {message}");
            ExitCode::FAILURE
        }
    }
}
