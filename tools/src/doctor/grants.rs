//! Grants: every call that the daemon needs, tried, and what grants it where it is refused.
//!
//! Must never keep what was granted: scheduling is tried on a thread that ends, locked memory is unlocked.

use daemon::executor::Refusal;
use daemon::executor::host;
use ipc::clock::Span;
use rustix::process::{Resource, getrlimit};

use super::{Bearing, Finding, text};

/// What grants everything, in a unit and without one.
const UNIT: &str = "in the unit: AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK, LimitRTPRIO=99, LimitMEMLOCK=infinity\n\
                    without a unit: setcap cap_sys_nice,cap_ipc_lock+ep $(command -v subsumed)";

/// Tries every call.
pub(super) fn look(period: Option<Span>) -> Vec<Finding> {
    let asked = period.is_some();
    vec![
        tried("SCHED_FIFO", asked, on_a_thread(|| host::schedule_fifo(80))),
        tried(
            "SCHED_DEADLINE",
            false,
            on_a_thread(|| host::schedule_deadline(Span::micros(100), Span::millis(10), false)),
        ),
        tried("locked memory", asked, lock()),
        limits(),
        privileges(),
    ]
}

fn on_a_thread(call: impl FnOnce() -> Result<(), Refusal> + Send + 'static) -> Result<(), Refusal> {
    std::thread::spawn(call).join().unwrap_or(Ok(()))
}

fn lock() -> Result<(), Refusal> {
    host::lock_memory()?;
    // With all memory to come locked as well, a limit shows at the next mapping: as big as a layer's stack.
    let thread = std::thread::Builder::new().stack_size(2 << 20).spawn(|| ());
    let _ = rustix::mm::munlockall();
    match thread {
        Ok(thread) => {
            let _ = thread.join();
            Ok(())
        }
        Err(e) => Err(Refusal {
            call: "mlockall was granted, but then pthread_create".into(),
            errno: e.raw_os_error().map_or_else(
                || e.to_string(),
                |code| host::name(rustix::io::Errno::from_raw_os_error(code)),
            ),
            grants: "the limit of locked memory is too small for the threads' stacks".into(),
        }),
    }
}

fn tried(what: &'static str, needed: bool, result: Result<(), Refusal>) -> Finding {
    match result {
        Ok(()) => Finding::new(what, "granted", Bearing::Good, ""),
        Err(refusal) => {
            let bearing = if needed { Bearing::Bad } else { Bearing::Note };
            let found = format!("refused: {} ({})", refusal.call, refusal.errno);
            Finding::new(what, found, bearing, refusal.grants).change(UNIT)
        }
    }
}

fn limits() -> Finding {
    let show = |limit: Option<u64>| limit.map_or("unlimited".into(), |l| l.to_string());
    let memory = getrlimit(Resource::Memlock).current;
    let priority = getrlimit(Resource::Rtprio).current;
    let time = getrlimit(Resource::Rttime).current;
    let found = format!(
        "memlock {} bytes, rtprio {}, rttime {} us",
        show(memory),
        show(priority),
        show(time)
    );
    Finding::new(
        "limits",
        found,
        Bearing::Good,
        "what counts is whether the calls above are granted",
    )
}

/// What of the process's standing explains refusals.
fn privileges() -> Finding {
    let status = text("/proc/self/status").unwrap_or_default();
    let field = |name: &str| {
        status
            .lines()
            .find_map(|l| l.strip_prefix(name))
            .map(str::trim)
            .unwrap_or("")
    };
    let effective = u64::from_str_radix(field("CapEff:"), 16).unwrap_or(0);
    let has = |bit: u32| if effective & (1 << bit) != 0 { "yes" } else { "no" };
    let mut traps = Vec::new();
    if text("/proc/self/uid_map").is_some_and(|map| !map.split_whitespace().eq(["0", "0", "4294967295"])) {
        traps.push("in a user namespace (PrivateUsers=yes): its capabilities do not count for scheduling");
    }
    if field("Seccomp:") == "2" {
        traps.push("under a system call filter: RestrictRealtime=yes and SystemCallFilter=~@resources refuse SCHED_FIFO");
    }
    let found = format!("CAP_SYS_NICE {}, CAP_IPC_LOCK {}", has(23), has(14));
    match traps.is_empty() {
        true => Finding::new("privileges", found, Bearing::Good, ""),
        false => Finding::new("privileges", found, Bearing::Note, traps.join("; ")),
    }
}
