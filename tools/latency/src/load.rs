//! Loads: what else the processor under test has to do meanwhile.
//!
//! Must never load more than the one processor, nor outlive the run: each load is a process of its own that is
//! killed when it is dropped, dies with its parent, and ends by itself after a while.

use std::io::Write as _;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use ipc::clock::Span;

/// A load by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Load {
    /// Nothing else.
    Idle,
    /// Two processes that compute without end.
    Cpu,
    /// A process that moves 64 MiB about, so that caches hold nothing of ours.
    Memory,
    /// A process that writes files and waits for the disk, and one that talks over sockets.
    Io,
    /// Readers and tapping layers that attach, detach and are killed, 200 a minute.
    Churn,
}

impl Load {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Load::Idle => "idle",
            Load::Cpu => "cpu",
            Load::Memory => "memory",
            Load::Io => "io",
            Load::Churn => "churn",
        }
    }

    /// The workers it is made of.
    fn workers(self) -> &'static [&'static str] {
        match self {
            Load::Idle | Load::Churn => &[],
            Load::Cpu => &["compute", "compute"],
            Load::Memory => &["copy"],
            Load::Io => &["write", "talk"],
        }
    }
}

/// The name under which this program is started to be a worker.
pub const WORKER: &str = "subsumed-lab-load";

/// Longest that a worker runs, whatever its parent does.
const WORKER_MAX: Duration = Duration::from_secs(3600);

/// Bytes that the memory load moves.
const COPIED: usize = 64 << 20;

/// A load that runs.
#[derive(Debug)]
pub struct Loaded(Vec<Child>);

impl Loaded {
    /// Starts `load` on processor `cpu`.
    ///
    /// # Errors
    /// When a worker cannot be started.
    pub fn start(load: Load, cpu: usize) -> std::io::Result<Loaded> {
        let mut loaded = Loaded(Vec::new());
        for worker in load.workers() {
            let program = std::env::current_exe()?;
            let child = Command::new(program)
                .arg0(WORKER)
                .arg(worker)
                .arg(cpu.to_string())
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .spawn()?;
            loaded.0.push(child);
        }
        Ok(loaded)
    }
}

impl Drop for Loaded {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// What a worker does, given its arguments.
pub fn work(arguments: &[String]) -> ExitCode {
    let [what, cpu] = arguments else {
        return ExitCode::from(2);
    };
    let parent = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
    let bound = cpu.parse().map(daemon::executor::host::bind);
    if parent.is_err() || !matches!(bound, Ok(Ok(()))) {
        eprintln!("a load could not be bound to processor {cpu}");
        return ExitCode::FAILURE;
    }
    let end = Instant::now() + WORKER_MAX;
    match what.as_str() {
        "compute" => compute(end),
        "copy" => copy(end),
        "write" => write(end).unwrap_or(()),
        "talk" => talk(end).unwrap_or(()),
        _ => return ExitCode::from(2),
    }
    ExitCode::SUCCESS
}

fn compute(end: Instant) {
    let mut x = 1.0_f64;
    while Instant::now() < end {
        for _ in 0..100_000 {
            x = std::hint::black_box((x * 1.000_001).sqrt() + 0.5);
        }
    }
}

fn copy(end: Instant) {
    let (mut from, mut to) = (vec![1_u8; COPIED], vec![0_u8; COPIED]);
    while Instant::now() < end {
        to.copy_from_slice(std::hint::black_box(&from));
        std::mem::swap(&mut from, &mut to);
    }
}

/// Writes a megabyte, waits until it is on the disk, again and again.
fn write(end: Instant) -> std::io::Result<()> {
    let path = std::env::temp_dir().join(format!("subsumed-lab-{}", std::process::id()));
    let mut file = std::fs::File::create(&path)?;
    // Nobody else needs its name, and nothing is left if we are killed.
    std::fs::remove_file(&path)?;
    let block = vec![7_u8; 1 << 20];
    while Instant::now() < end {
        file.write_all(&block)?;
        file.sync_data()?;
        file.set_len(0)?;
    }
    Ok(())
}

/// Two ends of a socket, a byte to and fro.
fn talk(end: Instant) -> std::io::Result<()> {
    use std::io::Read as _;
    let (mut near, mut far) = std::os::unix::net::UnixStream::pair()?;
    let mut block = [0_u8; 4096];
    while Instant::now() < end {
        near.write_all(&block)?;
        far.read_exact(&mut block)?;
    }
    Ok(())
}

/// Time between two events of the churn: 200 a minute.
pub const CHURN_EVERY: Span = Span::millis(300);
