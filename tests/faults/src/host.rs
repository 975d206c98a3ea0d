//! Faults around the daemon: a second one of its name, no file descriptors left, shared memory full.
//!
//! Must never fill anything that others use: full is only what belongs to this stage alone.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

use ipc::clock;
use ipc::control::{Connection, Reply};
use rustix::process::{Pid, Resource, Rlimit, Signal, prlimit};

use crate::callers::{Callers, greeting};
use crate::lives::{at_a_free_moment, body_halts_about};
use crate::trial::{BODY, CREATURE, Trial, leave_body};

/// File descriptors that a daemon has which is to use them up: a few more than it needs to start.
const DESCRIPTORS: &str = "64";

/// A second daemon of the same name is refused, and the first does not notice.
pub(crate) fn second_daemon(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut second = trial
            .stage
            .start(&trial.programs.subsumed, &["--name", CREATURE, "--headless"])?;
        let status = second.end()?;
        trial.outcome.expect(status.code() == Some(1), || {
            format!("the second daemon ended with {status}: {:?}", second.said())
        });
        Ok(())
    })
}

/// Callers take every file descriptor that the daemon may have.
pub(crate) fn descriptors_used_up(trial: &mut Trial) -> Result<(), String> {
    let life_s = &trial.life_s;
    let script = format!(
        "ulimit -n {DESCRIPTORS}; exec \"$0\" --name {CREATURE} --headless --body {BODY} --seconds {life_s}"
    );
    let program = trial.programs.subsumed.to_string_lossy().into_owned();
    let mut body = trial.body()?;
    let daemon = trial.stage.start("sh", &["-c", &script, &program])?;
    trial.wait_until_free(&daemon)?;
    trial.look_at_status()?;
    trial.goes_on_with(daemon, |trial| {
        let callers: Vec<UnixStream> = (0..200)
            .map_while(|_| UnixStream::connect(trial.stage.socket(CREATURE)).ok())
            .collect();
        trial
            .outcome
            .expect(callers.len() > 64, || format!("{} callers only", callers.len()));
        std::thread::sleep(Duration::from_millis(200));
        drop(callers);
        // The places come free again, and a layer finds one.
        trial.wait_until_answered()?;
        trial.wander()?.leave()
    })?;
    leave_body(trial, &mut body);
    Ok(())
}

/// Callers that come while the daemon is at its limit: each is a conversation that it has to find room for.
const CALLERS: usize = 40;

/// Memory that is left to the daemon: less than it keeps for itself, so that nobody is let in; or a little more, so that
/// some are, until there is no room for the next one's thread.
const LEFT: [u64; 2] = [6 << 20, 12 << 20];

/// The daemon may have little more memory than it has: there are no threads for all callers.
pub(crate) fn memory_limited(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let daemon = trial.daemon_pid()?;
        let left = LEFT[(trial.draw() % 2) as usize];
        limit(daemon, Some(address_space(daemon)? + left))?;
        let callers: Vec<Connection> = (0..CALLERS)
            .filter_map(|_| greeting(&trial.stage.socket(CREATURE)).ok())
            .collect();
        let mut layer = trial
            .stage
            .start(&trial.programs.wander, &["--creature", CREATURE])?;
        std::thread::sleep(Duration::from_millis(300));
        let answered = callers.into_iter().filter_map(|mut caller| {
            let answer = caller.receive::<Reply>().ok()??;
            matches!(answer, Reply::Welcome { .. }).then_some(())
        });
        let answered = answered.count();
        trial.outcome.expect(answered == 0 || left > LEFT[0], || {
            format!("{answered} callers were answered with {left} bytes left: the limit is none")
        });
        limit(daemon, None)?;
        // Refused or kept waiting, it is gone; there is room again for the next one.
        layer.end_by(Signal::KILL)?;
        trial.wait_until_answered()?;
        trial.wander()?.leave()
    })
}

/// The daemon may have no more memory than it has: it ends at the next piece that it cannot do without.
pub(crate) fn memory_used_up(trial: &mut Trial) -> Result<(), String> {
    let mut body = trial.body()?;
    let mut daemon = trial.daemon(&["--body", BODY])?;
    trial.in_rounds(|trial| {
        let (observer, _) = at_a_free_moment(trial)?;
        let pid = trial.daemon_pid()?;
        let limited = clock::monotonic();
        limit(pid, Some(0))?;
        // Each wants a place, and a thread.
        let callers = Callers::of(trial.stage.socket(CREATURE));
        let (began, mut alive) = (Instant::now(), clock::monotonic());
        while !daemon.has_ended() && began.elapsed() < stage::PATIENCE {
            alive = clock::monotonic();
            std::thread::sleep(Duration::from_millis(1));
        }
        drop(callers);
        // A process that ends lets go of its socket before it is seen to have ended: the gate may close before.
        body_halts_about(trial, &observer, limited, alive);
        let status = daemon.end()?;
        trial
            .outcome
            .expect(!status.success(), || format!("without memory: {status}"));
        drop(observer);
        daemon = trial.restart()?;
        Ok(())
    })?;
    trial.end(&mut daemon)?;
    leave_body(trial, &mut body);
    Ok(())
}

/// Bytes of address space that a process has.
fn address_space(pid: Pid) -> Result<u64, String> {
    let path = format!("/proc/{}/statm", pid.as_raw_nonzero());
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
    let pages = text.split_whitespace().next().and_then(|n| n.parse::<u64>().ok());
    let pages = pages.ok_or_else(|| format!("{path} holds {text:?}"))?;
    Ok(pages * rustix::param::page_size() as u64)
}

/// Limits the address space of a process; none takes the limit away.
fn limit(pid: Pid, bytes: Option<u64>) -> Result<(), String> {
    let limit = Rlimit {
        current: bytes,
        maximum: None,
    };
    prlimit(Some(pid), Resource::As, limit)
        .map(drop)
        .map_err(|e| format!("prlimit(RLIMIT_AS): {e}"))
}

/// Shared memory is full: on a file system that is this stage's alone (see the suite).
pub(crate) fn memory_full(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let ballast = Path::new("/dev/shm/ballast");
        let filled = fill(ballast)?;
        trial
            .outcome
            .expect(filled > 0, || "there was no room to fill".into());
        let mut other = trial.stage.start(
            &trial.programs.subsumed,
            &["--name", "other", "--headless", "--seconds", "2"],
        )?;
        let status = other.end()?;
        trial.outcome.expect(status.code() == Some(1), || {
            format!(
                "a daemon started without shared memory ended with {status}: {:?}",
                other.said()
            )
        });
        let mut layer = trial
            .stage
            .start(&trial.programs.wander, &["--creature", CREATURE])?;
        let status = layer.end()?;
        let refused = layer.said().iter().any(|l| l.contains("shared memory is full"));
        trial.outcome.expect(status.code() == Some(1) && refused, || {
            format!(
                "a layer without shared memory ended with {status}: {:?}",
                layer.said()
            )
        });
        if trial.outcome.injections == 1 {
            // Long enough for everybody to have wanted to clean up after the dead.
            std::thread::sleep(Duration::from_millis(2500));
        }
        std::fs::remove_file(ballast).map_err(|e| format!("{}: {e}", ballast.display()))?;
        trial.wander()?.leave()
    })
}

/// Fills the file system that `path` is on; how many bytes that took.
fn fill(path: &Path) -> Result<usize, String> {
    /// More than any file system made for a trial has.
    const FILL_MAX: usize = 64 << 20;
    let mut file = std::fs::File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut filled = 0;
    for size in [4096, 64] {
        while filled < FILL_MAX && file.write_all(&vec![1; size]).is_ok() {
            filled += size;
        }
    }
    match filled < FILL_MAX {
        true => Ok(filled),
        false => Err("shared memory is not this stage's alone".into()),
    }
}
