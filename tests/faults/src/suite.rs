//! The suite: every trial in a process of its own, on a stage of its own; then a look at what it left behind.
//!
//! ```text
//!   suite ── stage ──► `faults inject CAUSE` ──► daemon, body, layers ──► outcome, one line of JSON
//!         ◄── what is left in shared memory, in iceoryx2's directory, in the run directory ── nothing
//! ```
//! Must never run two trials at once that take a core to themselves: nothing would be left to halt them. Others
//! may run side by side, as each other's load.

use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use signal_hook::consts::SIGINT;
use stage::Stage;

use crate::causes::Cause;
use crate::kept::Kept;
use crate::outcome::Outcome;
use crate::programs::Programs;

/// How long a trial may take in all before it is given up as hanging, and so much more for every round.
const TRIAL_MAX: Duration = Duration::from_secs(150);
const ROUND_MAX: Duration = Duration::from_secs(10);

/// How long dead and leaving processes may take to be gone from the stage.
const GONE_MAX: Duration = Duration::from_secs(3);

/// Size of the shared memory of a trial that fills it.
const OWN_MEMORY: &str = "4m";

/// How trials are made.
pub(crate) struct Plan {
    /// Injections of each.
    pub(crate) rounds: u64,
    /// How many run at once.
    pub(crate) jobs: usize,
}

/// Makes all of these trials, and keeps what came of each as soon as it is known.
///
/// # Errors
/// When no process can be started at all, or nothing kept.
pub(crate) fn inject_all(
    programs: &Programs,
    wanted: Vec<(u64, &'static Cause)>,
    plan: &Plan,
    kept: &mut Kept,
) -> Result<(), String> {
    let queue = Queue {
        interrupted: on_interrupt()?,
        began: Instant::now(),
        next: AtomicUsize::new(0),
        cores: Cores::of_the_host(),
        kept: Mutex::new((kept, 0)),
        wanted,
        rounds: plan.rounds,
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..plan.jobs)
            .map(|_| scope.spawn(|| queue.work(programs)))
            .collect();
        let ended = |worker: ScopedJoinHandle<'_, _>| worker.join();
        let mut ended = workers.into_iter().map(ended);
        ended.try_for_each(|result| result.unwrap_or_else(|_| Err("a trial's thread panicked".into())))
    })
}

/// Cores that real-time threads of trials may keep busy: all but one, on which everybody else's threads run.
struct Cores {
    all: usize,
    free: Mutex<usize>,
    given_back: Condvar,
}

impl Cores {
    fn of_the_host() -> Cores {
        let host = std::thread::available_parallelism().map_or(1, usize::from);
        let all = host.saturating_sub(1).max(1);
        Cores {
            all,
            free: Mutex::new(all),
            given_back: Condvar::new(),
        }
    }

    /// Waits until so many are free, and takes them; all, if there are fewer.
    fn take(&self, wanted: usize) -> usize {
        let wanted = wanted.min(self.all);
        let free = self.free.lock().expect("nobody panics holding it");
        let enough = self.given_back.wait_while(free, |free| *free < wanted);
        *enough.expect("nobody panics holding it") -= wanted;
        wanted
    }

    fn give_back(&self, taken: usize) {
        *self.free.lock().expect("nobody panics holding it") += taken;
        self.given_back.notify_all();
    }
}

/// Trials that are still to be made, and where their outcomes go.
struct Queue<'a> {
    wanted: Vec<(u64, &'static Cause)>,
    rounds: u64,
    next: AtomicUsize,
    interrupted: Arc<AtomicBool>,
    began: Instant,
    cores: Cores,
    /// And how many were made.
    kept: Mutex<(&'a mut Kept, usize)>,
}

impl<'a> Queue<'a> {
    /// Makes trials until none is left, or Ctrl-C.
    fn work(&self, programs: &Programs) -> Result<(), String> {
        while !self.interrupted.load(Ordering::Relaxed) {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(&(seed, cause)) = self.wanted.get(number) else {
                break;
            };
            let skipped = |kept: &Kept| kept.of(cause.name).any(|(_, o)| o.skipped.is_some());
            if skipped(self.lock().0) {
                continue;
            }
            let taken = self.cores.take(cause.cores);
            let outcome = inject(programs, cause, seed, self.rounds, number + 1);
            self.cores.give_back(taken);
            let outcome = outcome?;
            self.tell(seed, cause, &outcome);
            self.lock().0.add(cause.name, seed, outcome)?;
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, (&'a mut Kept, usize)> {
        self.kept.lock().expect("nobody panics holding what is kept")
    }

    fn tell(&self, seed: u64, cause: &Cause, outcome: &Outcome) {
        let mut kept = self.lock();
        kept.1 += 1;
        let (made, all) = (kept.1, self.wanted.len());
        let left = self.began.elapsed().as_secs_f64() / made as f64 * all.saturating_sub(made) as f64;
        let result = if outcome.broken.is_empty() {
            "as specified"
        } else {
            "NOT AS SPECIFIED"
        };
        eprintln!(
            "{made:6} of {all}, {}:{:02} left  {:17} --seed {seed}: {result}",
            left as u64 / 60,
            left as u64 % 60,
            cause.name
        );
        for broken in &outcome.broken {
            eprintln!("{} --seed {seed}: {broken}", cause.name);
        }
    }
}

/// Tries `cause` with `rounds` injections, the `number`-th trial of a run.
///
/// # Errors
/// When no process can be started at all.
fn inject(
    programs: &Programs,
    cause: &Cause,
    seed: u64,
    rounds: u64,
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
    command.args(["--rounds", &rounds.to_string()]);
    // Ctrl-C is for us: the trial under way comes to its end.
    command.process_group(0);
    let child = command.stdout(Stdio::piped()).spawn();
    let child = child.map_err(|e| format!("{:?} does not start: {e}", command.get_program()))?;
    let mut outcome = finish(child, TRIAL_MAX + ROUND_MAX * rounds as u32);
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

/// Waits for a trial for as long as `limit`, and reads what came of it.
fn finish(mut child: Child, limit: Duration) -> Outcome {
    let began = Instant::now();
    let broken = |text: String| Outcome {
        broken: vec![text],
        ..Outcome::default()
    };
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if began.elapsed() < limit => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return broken("the trial hangs".into());
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
    said.unwrap_or_else(|| broken(format!("the trial ended with {status} and no outcome")))
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
