//! The listener: the other process, which polls and notes how old what it found is.
//!
//! Must never be real-time: it polls without a pause.

use std::cell::Cell;
use std::fmt::Write as _;
use std::process::ExitCode;

use ipc::clock::{self, Time};
use ipc::wire::iceoryx::Domain;
use nix::sys::resource::{UsageWho, getrusage};

use super::means::Ears;
use super::turn;

/// The name under which this program is started to be a listener.
pub const WORKER: &str = "subsumed-lab-listener";

/// Polls between two looks at the clock, which takes longer than a poll.
const POLLS: u32 = 64;

/// How often the host took the processor away from this thread.
fn times_lost() -> i64 {
    getrusage(UsageWho::RUSAGE_THREAD).map_or(0, |usage| usage.involuntary_context_switches())
}

/// What a process started as [`WORKER`] does, given its arguments: the speaker's name, where its sequence lock is, the
/// end, the processor to run on. It listens until the end and writes one line for each message: its number and its
/// age in nanoseconds. What came while the host had taken its processor away is left out.
pub fn listen(arguments: &[String]) -> ExitCode {
    match work(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{WORKER}: {message}");
            ExitCode::FAILURE
        }
    }
}

fn work(arguments: &[String]) -> Result<(), String> {
    let [name, seqlock, end, cpu] = arguments else {
        return Err("expected a name, a path, an end and a processor".into());
    };
    let end = Time(end.parse().map_err(|e| format!("{end:?}: {e}"))?);
    let cpu = cpu.parse().map_err(|e| format!("{cpu:?}: {e}"))?;
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
    daemon::executor::host::bind(cpu).map_err(|e| e.to_string())?;
    let domain = Domain::join(&format!("{name}-listener")).map_err(|e| e.to_string())?;
    let ears = Ears::open(&domain, name, seqlock)?;
    let polls = Cell::new(0_u32);
    let over = || {
        polls.set(polls.get().wrapping_add(1));
        polls.get().is_multiple_of(POLLS) && clock::monotonic() >= end
    };
    // No line is longer than forty characters; a beat is no shorter than 100 µs.
    let room = 40 * (end.since(clock::monotonic()).0 / 100_000) as usize;
    let mut lines = String::with_capacity(room.min(1 << 26));
    let mut seen = 0;
    loop {
        let (lost, since) = (times_lost(), clock::monotonic());
        let Some((number, stamp)) = ears.await_newer(turn(seen + 1), seen, over) else {
            break;
        };
        let age = clock::monotonic().since(stamp);
        // An age is the message's only if its listener was there when it came.
        if stamp >= since && lost == times_lost() {
            let _ = writeln!(lines, "{number} {}", age.0);
        }
        seen = number;
    }
    drop(ears);
    domain.leave();
    print!("{lines}");
    Ok(())
}
