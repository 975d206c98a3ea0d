//! Faults around the daemon: a second one of its name, no file descriptors left, shared memory full.
//!
//! Must never fill anything that others use: full is only what belongs to this stage alone.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::path::Path;

use crate::stage::{CREATURE, LIFE_S, wait_for};
use crate::trial::Trial;

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
    let script =
        format!("ulimit -n {DESCRIPTORS}; exec \"$0\" --name {CREATURE} --headless --seconds {LIFE_S}");
    let program = trial.programs.subsumed.to_string_lossy().into_owned();
    let daemon = trial.stage.start("sh", &["-c", &script, &program])?;
    trial.wait_until_free(&daemon)?;
    trial.goes_on_with(daemon, |trial| {
        let callers: Vec<UnixStream> = (0..200)
            .map_while(|_| UnixStream::connect(trial.stage.socket()).ok())
            .collect();
        trial
            .outcome
            .expect(callers.len() > 64, || format!("{} callers only", callers.len()));
        std::thread::sleep(std::time::Duration::from_millis(200));
        drop(callers);
        // The places come free again, and a layer finds one.
        trial.wander()?.leave()
    })
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
        let said = wait_for("the layer says why", || !layer.said().is_empty());
        trial.outcome.expect(said.is_ok(), || {
            "a layer without shared memory says nothing".into()
        });
        layer.end_by(rustix::process::Signal::KILL)?;
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
