//! What the host grants: locked memory, real-time scheduling, affinity; and what to do where it refuses.
//!
//! Must never change anything outside this process.

use rustix::io::Errno;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use rustix::thread::{CapabilitySet, CpuSet, capabilities, sched_setaffinity};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ScheduleParams, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

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

/// Sees to it that a runaway real-time thread ends the process instead of starving the host.
pub fn limit_runaway() {
    let limit = Rlimit {
        current: Some(RUNAWAY_US),
        maximum: Some(RUNAWAY_US),
    };
    // A stricter limit may be in force; then that one does.
    let _ = setrlimit(Resource::Rttime, limit);
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
        errno: match e {
            thread_priority::Error::OS(code) => name(Errno::from_raw_os_error(code)),
            other => format!("{other:?}"),
        },
        grants: "granted by CAP_SYS_NICE, by LimitRTPRIO=99 in the unit, or by `ulimit -r 99`; also refused \
                 inside a cpu control group under RT_GROUP_SCHED, by RestrictRealtime= and in user namespaces"
            .into(),
    })
}

/// Binds the calling thread to processor `cpu`.
///
/// # Errors
/// The refusal.
pub fn bind(cpu: usize) -> Result<(), Refusal> {
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

fn name(errno: Errno) -> String {
    match errno {
        Errno::PERM => "EPERM".into(),
        Errno::NOMEM => "ENOMEM".into(),
        Errno::AGAIN => "EAGAIN".into(),
        Errno::INVAL => "EINVAL".into(),
        Errno::ACCESS => "EACCES".into(),
        other => other.to_string(),
    }
}
