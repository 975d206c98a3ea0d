//! What the host grants: locked memory, real-time scheduling, affinity; and what to do where it refuses.
//!
//! Must never change anything outside this process.

use std::fs::File;
use std::io::Read;
use std::num::NonZeroU64;
use std::sync::OnceLock;
use std::time::Duration;

use nix::sys::signal::{SigSet, Signal};
use rustix::io::Errno;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use rustix::thread::{
    CapabilitySet, CpuSet, capabilities, sched_getaffinity, sched_setaffinity, set_current_timer_slack,
};
use thread_priority::{
    DeadlineFlags, NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ScheduleParams, ThreadPriority,
    ThreadSchedulePolicy, set_thread_priority_and_policy, thread_native_id, thread_schedule_policy,
};

use super::plan::{Plan, Schedule};
use super::refused;
use ipc::clock::Span;

/// Longest a SCHED_FIFO thread may run without sleeping before the kernel ends the process: a runaway
/// thread would otherwise own its processor for 95 % of every second, for good.
const RUNAWAY_US: u64 = 500_000;

/// A call that the host refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The call.
    pub call: String,
    /// The errno, by name.
    pub errno: String,
    /// What grants it.
    pub grants: String,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} was refused ({}); {}", self.call, self.errno, self.grants)
    }
}

/// Locks all memory, present and future, so that no page of it is ever missing.
///
/// # Errors
/// The refusal, with what grants it.
pub fn lock_memory() -> Result<(), Refusal> {
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|errno| Refusal {
        call: "mlockall(MCL_CURRENT | MCL_FUTURE)".into(),
        errno: name(errno),
        grants: "granted by CAP_IPC_LOCK, by LimitMEMLOCK=infinity in the unit, or by `ulimit -l unlimited`"
            .into(),
    })
}

/// How much memory this process may lock; `None` if there is no limit.
pub fn lockable_bytes() -> Option<u64> {
    let free = capabilities(None).is_ok_and(|c| c.effective.contains(CapabilitySet::IPC_LOCK));
    if free {
        None
    } else {
        getrlimit(Resource::Memlock).current
    }
}

/// How much more address space this process may take (`RLIMIT_AS`), in bytes; `None` if there is no limit. Takes no
/// memory itself, and where the host does not say how much is taken there is nothing left.
pub fn address_space_left() -> Option<u64> {
    let limit = getrlimit(Resource::As).current?;
    let pages = pages_taken().unwrap_or(u64::MAX);
    Some(limit.saturating_sub(pages.saturating_mul(rustix::param::page_size() as u64)))
}

/// Pages of address space that this process has.
fn pages_taken() -> Option<u64> {
    let mut text = [0; 128];
    let read = File::open("/proc/self/statm").ok()?.read(&mut text).ok()?;
    let text = std::str::from_utf8(&text[..read]).ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// Sees to it that a runaway real-time thread ends the process instead of starving the host.
pub fn limit_runaway() {
    let limit = Rlimit {
        current: Some(RUNAWAY_US),
        maximum: Some(RUNAWAY_US),
    };
    // A stricter limit may be in force; then that one does.
    let _ = setrlimit(Resource::Rttime, limit);
}

/// Gives the calling thread what `plan` asks for; says what was refused.
pub fn settle(plan: &Plan) -> Vec<Refusal> {
    tighten_timers();
    refuse_signals();
    let bound = match plan.cpu {
        Some(cpu) => bind(cpu),
        None => {
            roam();
            Ok(())
        }
    };
    let scheduled = match plan.schedule {
        Schedule::Ordinary => Ok(()),
        Schedule::Fifo(priority) => schedule_fifo(priority),
        Schedule::Deadline { runtime, period } => schedule_deadline(runtime, period, plan.cpu.is_some()),
    };
    [bound, scheduled].into_iter().filter_map(Result::err).collect()
}

/// Timers of the calling thread ring as exactly as the host can: matters under the ordinary scheduler, whose
/// timers may otherwise be 50 µs late on purpose.
fn tighten_timers() {
    // Cannot fail for the calling thread; if it did, beats would be 50 µs later in best effort.
    let _ = set_current_timer_slack(NonZeroU64::new(1));
}

/// Leaves the process's signals to its other threads: a handler on a beating thread would run within a beat, and
/// even a signal that nobody handles interrupts its sleep. Those that a thread's own faults raise stay.
fn refuse_signals() {
    let mut signals = SigSet::all();
    let own = [
        Signal::SIGBUS,
        Signal::SIGSEGV,
        Signal::SIGFPE,
        Signal::SIGILL,
        Signal::SIGTRAP,
        Signal::SIGABRT,
    ];
    own.into_iter().for_each(|signal| signals.remove(signal));
    // Fails for arguments that don't exist alone; if it did, the kernel would choose among all threads as before.
    let _ = signals.thread_block();
}

/// Puts the calling thread under the ordinary scheduler if it is not there: whoever starts the daemon under a
/// real-time policy would otherwise hand it on to every helper thread.
///
/// # Errors
/// The refusal.
pub fn be_ordinary() -> Result<(), Refusal> {
    let other = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
    if thread_schedule_policy().is_ok_and(|policy| policy == other) {
        return Ok(());
    }
    // 48 of 99 on the crate's scale is niceness 0, that of a process nobody was nice to.
    let middle = ThreadPriority::from_posix(ScheduleParams { sched_priority: 48 });
    set_thread_priority_and_policy(thread_native_id(), middle, other).map_err(|e| Refusal {
        call: "sched_setscheduler(SCHED_OTHER)".into(),
        errno: errno_of(&e),
        grants: "start the daemon from a shell or unit that has no real-time policy".into(),
    })
}

/// Niceness of ordinary threads that are waited for: about 28 shares of a processor to another thread's one.
const NICE_FIRST: i32 = -15;

/// Puts the calling thread, an ordinary one, before others of the host: a simulated body that is slow to answer is
/// halted as if it were lost, a hungry watchdog restarts the daemon. Where that is not granted (CAP_SYS_NICE) it
/// stands among the others.
pub fn come_first() {
    let _ = rustix::process::setpriority_process(None, NICE_FIRST);
}

/// Puts the calling thread under SCHED_DEADLINE: `runtime` in every `period`.
///
/// # Errors
/// The refusal, with what grants it.
pub fn schedule_deadline(runtime: Span, period: Span, bound: bool) -> Result<(), Refusal> {
    let priority = ThreadPriority::Deadline {
        runtime: Duration::from_nanos(runtime.0),
        deadline: Duration::from_nanos(period.0),
        period: Duration::from_nanos(period.0),
        flags: DeadlineFlags::RESET_ON_FORK,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Deadline);
    // Zero names the calling thread; a pthread's own number would not.
    set_thread_priority_and_policy(0, priority, policy).map_err(|_| Refusal {
        call: format!("sched_setattr(SCHED_DEADLINE, {runtime} in {period})"),
        errno: name(Errno::from_io_error(&std::io::Error::last_os_error()).unwrap_or(Errno::PERM)),
        grants: if bound {
            "a thread with `cpu` cannot have SCHED_DEADLINE: leave `cpu` out, or use policy = \"fifo\"".into()
        } else {
            "granted by CAP_SYS_NICE while the sum of all reservations stays below 95 % of each processor \
             (EBUSY: it does not), outside of cpusets that are not exclusive"
                .into()
        },
    })
}

/// Puts the calling thread under SCHED_FIFO at `priority`.
///
/// # Errors
/// The refusal, with what grants it.
pub fn schedule_fifo(priority: u8) -> Result<(), Refusal> {
    let posix = ThreadPriority::from_posix(ScheduleParams {
        sched_priority: i32::from(priority),
    });
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), posix, fifo).map_err(|e| Refusal {
        call: format!("sched_setscheduler(SCHED_FIFO, {priority})"),
        errno: errno_of(&e),
        grants: format!(
            "granted by CAP_SYS_NICE, by LimitRTPRIO=99 in the unit, or by `ulimit -r 99`; also refused \
             inside a cpu control group under RT_GROUP_SCHED, by RestrictRealtime= and in user namespaces{}",
            refused::found()
        ),
    })
}

/// The processors that this process was given, by the host's numbers, wherever the calling thread may run now.
pub fn processors() -> Vec<usize> {
    let set = given();
    (0..CpuSet::MAX_CPU).filter(|cpu| set.is_set(*cpu)).collect()
}

/// The processors that the first thread to ask was allowed: those of the process, before any thread was bound.
fn given() -> &'static CpuSet {
    static GIVEN: OnceLock<CpuSet> = OnceLock::new();
    GIVEN.get_or_init(|| sched_getaffinity(None).unwrap_or_else(|_| CpuSet::new()))
}

/// Keeps the calling thread, and all that it starts from now on, off the processors `taken`, which beating threads are
/// bound to: whatever else runs there takes their lines of cache. Where no other is left it stays. A beating thread that
/// is bound to none is not held by this (see [`settle`]).
pub fn keep_off(taken: impl IntoIterator<Item = usize>) {
    let mut left = *given();
    let taken = taken.into_iter().filter(|cpu| *cpu < CpuSet::MAX_CPU);
    taken.for_each(|cpu| left.unset(cpu));
    if left.count() > 0 {
        // Refused: the set was taken smaller meanwhile, and the kernel keeps within it.
        let _ = sched_setaffinity(None, &left);
    }
}

/// Lets the calling thread, and all that it starts from now on, run on every processor that the process was given.
pub fn roam() {
    if sched_getaffinity(None).is_ok_and(|now| now != *given()) {
        let _ = sched_setaffinity(None, given());
    }
}

/// Binds the calling thread to processor `cpu`.
///
/// # Errors
/// The refusal.
pub fn bind(cpu: usize) -> Result<(), Refusal> {
    given();
    let mut set = CpuSet::new();
    if cpu < CpuSet::MAX_CPU {
        set.set(cpu);
    }
    sched_setaffinity(None, &set).map_err(|errno| Refusal {
        call: format!("sched_setaffinity(cpu {cpu})"),
        errno: name(errno),
        grants:
            "expected the number of a processor that is online and in this process's set (see `nproc --all`)"
                .into(),
    })
}

fn errno_of(e: &thread_priority::Error) -> String {
    match e {
        thread_priority::Error::OS(code) => name(Errno::from_raw_os_error(*code)),
        other => format!("{other:?}"),
    }
}

/// An errno by its name.
pub fn name(errno: Errno) -> String {
    match errno {
        Errno::BUSY => "EBUSY".into(),
        Errno::PERM => "EPERM".into(),
        Errno::NOMEM => "ENOMEM".into(),
        Errno::AGAIN => "EAGAIN".into(),
        Errno::INVAL => "EINVAL".into(),
        Errno::ACCESS => "EACCES".into(),
        other => other.to_string(),
    }
}
