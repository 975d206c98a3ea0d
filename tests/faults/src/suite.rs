//! The suite: every injection in a process of its own, on a stage of its own; then a look at what it left behind.
//!
//! ```text
//!   suite ── stage ──► `faults inject CAUSE` ──► daemon, body, layers ──► outcome, one line of JSON
//!         ◄── what is left in shared memory, in iceoryx2's directory, in the run directory ── nothing
//! ```
//! Must never run two injections at once: they would be each other's load.

use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use signal_hook::consts::SIGINT;
use stage::Stage;

use crate::causes::Cause;
use crate::outcome::Outcome;
use crate::programs::Programs;

/// How long an injection may take in all before it is given up as hanging.
const INJECTION_MAX: Duration = Duration::from_secs(150);

/// How long dead and leaving processes may take to be gone from the stage.
const GONE_MAX: Duration = Duration::from_secs(3);

/// Size of the shared memory of an injection that fills it.
const OWN_MEMORY: &str = "4m";

/// Injects `cause` once, the `number`-th of a run.
///
/// # Errors
/// When no process can be started at all.
pub(crate) fn inject(
    programs: &Programs,
    cause: &Cause,
    seed: u64,
    number: usize,
) -> Result<Outcome, String> {
    let stage = Stage::new(&format!("faults{}n{number}", std::process::id()))?;
    if cause.own_memory && !can_unshare() {
        return Ok(Outcome {
            skipped: Some("no mount namespace of its own (needs root)".into()),
            ..Outcome::default()
        });
    }
    let mut command = if cause.own_memory {
        let mut command = stage.command("unshare");
        let script = format!("mount -t tmpfs -o size={OWN_MEMORY} tmpfs /dev/shm && exec \"$@\"");
        command
            .args(["--mount", "sh", "-c", &script, "sh"])
            .arg(&programs.ourselves);
        command
    } else {
        stage.command(&programs.ourselves)
    };
    command.args(["inject", cause.name, "--seed", &seed.to_string()]);
    // Ctrl-C is for us: the injection under way comes to its end.
    command.process_group(0);
    let child = command.stdout(Stdio::piped()).spawn();
    let child = child.map_err(|e| format!("{:?} does not start: {e}", command.get_program()))?;
    let mut outcome = finish(child);
    let left = left_behind(&stage);
    outcome.expect(left.is_empty(), || {
        // A few say which process it was; a hundred say no more.
        format!(
            "{} files left behind, as {:?}",
            left.len(),
            &left[..left.len().min(3)]
        )
    });
    Ok(outcome)
}

/// Waits for an injection, and reads what came of it.
fn finish(mut child: Child) -> Outcome {
    let began = Instant::now();
    let broken = |text: String| Outcome {
        broken: vec![text],
        ..Outcome::default()
    };
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if began.elapsed() < INJECTION_MAX => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return broken("the injection hangs".into());
            }
        }
    };
    let mut text = String::new();
    if let Some(mut out) = child.stdout.take() {
        // One line: less than a pipe holds.
        let _ = std::io::Read::read_to_string(&mut out, &mut text);
    }
    let said = text
        .lines()
        .last()
        .and_then(|line| serde_json::from_str(line).ok());
    said.unwrap_or_else(|| broken(format!("the injection ended with {status} and no outcome")))
}

/// What remains on the stage, with time for those who leave to be gone.
pub(crate) fn left_behind(stage: &Stage) -> Vec<String> {
    let began = Instant::now();
    loop {
        let files = stage.files();
        if files.is_empty() || began.elapsed() > GONE_MAX {
            return files.iter().map(|f| f.display().to_string()).collect();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A flag that Ctrl-C sets: what is under way comes to an end, and what was measured is reported.
///
/// # Errors
/// When the host refuses the handler.
pub(crate) fn on_interrupt() -> Result<Arc<AtomicBool>, String> {
    let flag = Arc::new(AtomicBool::new(false));
    // A second one ends us on the spot.
    let second = signal_hook::flag::register_conditional_shutdown(SIGINT, 130, flag.clone());
    let first = signal_hook::flag::register(SIGINT, flag.clone());
    second.and(first).map_err(|e| format!("SIGINT: {e}"))?;
    Ok(flag)
}

fn can_unshare() -> bool {
    let tried = Command::new("unshare")
        .args(["--mount", "mount", "-t", "tmpfs", "tmpfs", "/dev/shm"])
        .output();
    tried.is_ok_and(|output| output.status.success())
}
