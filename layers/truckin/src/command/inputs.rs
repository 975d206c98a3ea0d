//! What subcommands share: reading worlds and telling what went wrong.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::grid::GridFault;
use crate::ootland::{World, world_file};

/// Why a subcommand gave up.
#[derive(Debug)]
pub enum Trouble {
    /// What was asked for cannot be done as asked; exit status 2.
    BadInput(String),
    /// It should have worked; exit status 1.
    Failed(String),
    /// Somebody stopped it before it was done: with what was kept, and how to go on; exit status 130, as of Ctrl-C.
    Stopped(String),
    /// Whoever was reading has gone; nothing more to say, exit status 0.
    NobodyListens,
}

impl Trouble {
    /// The exit status.
    pub fn status(&self) -> u8 {
        match self {
            Self::BadInput(_) => 2,
            Self::Failed(_) => 1,
            Self::Stopped(_) => 130,
            Self::NobodyListens => 0,
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadInput(what) | Self::Failed(what) | Self::Stopped(what) => out.write_str(what),
            Self::NobodyListens => Ok(()),
        }
    }
}

impl From<GridFault> for Trouble {
    fn from(fault: GridFault) -> Self {
        match fault {
            GridFault::Bad { .. } => Self::BadInput(fault.to_string()),
            GridFault::Io { .. } | GridFault::Rules { .. } => Self::Failed(fault.to_string()),
        }
    }
}

/// Writes a line to standard output.
pub(super) fn say(line: &str) -> Result<(), Trouble> {
    match writeln!(io::stdout().lock(), "{line}") {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(Trouble::NobodyListens),
        Err(error) => Err(Trouble::Failed(format!("standard output: {error}"))),
    }
}

/// The world of a file, or the usual one.
pub(super) fn world(path: Option<&Path>) -> Result<World, Trouble> {
    let Some(path) = path else {
        return Ok(World::default());
    };
    let name = path.display();
    let text =
        std::fs::read_to_string(path).map_err(|error| Trouble::BadInput(format!("{name}: {error}")))?;
    world_file::read(&text).map_err(|faults| {
        let lines: Vec<String> = faults.iter().map(|fault| format!("{name}:{fault}")).collect();
        Trouble::BadInput(lines.join("\n"))
    })
}

/// Refuses a report that would take the place of a file that was read or written.
pub(super) fn apart(report: &Path, other: &Path) -> Result<(), Trouble> {
    let real = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if real(report) == real(other) {
        return Err(Trouble::BadInput(format!(
            "{}: would be overwritten by the report",
            other.display()
        )));
    }
    Ok(())
}

/// Threads to use: as many as asked for, or as the machine has.
pub(super) fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// Reads a number of threads.
pub(super) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("expected a whole number from 1".to_owned()),
        Ok(count) => Ok(count),
    }
}

/// A flag that Ctrl-C and SIGTERM raise; the second of them ends the program at once.
pub(super) fn stop_on_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        let _ = signal_hook::flag::register_conditional_default(signal, stop.clone());
        let _ = signal_hook::flag::register(signal, stop.clone());
    }
    stop
}
