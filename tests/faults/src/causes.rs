//! Causes: every fault that is injected, what is expected of it, and what runs it.
//!
//! Must never hold one that a run does not try or say that it skipped.

use rustix::process::Signal;

use crate::outcome::Expected;
use crate::rogue::Behaviour;
use crate::trial::Trial;
use crate::{host, layers, lives, stepped};

/// A fault.
pub(crate) struct Cause {
    /// Its name on the command line and in reports.
    pub(crate) name: &'static str,
    /// What is done, in a few words.
    pub(crate) about: &'static str,
    /// What is to come of it.
    pub(crate) expected: Expected,
    /// How the bound is made, in words.
    pub(crate) bound: &'static str,
    /// Whether it needs shared memory of its own.
    pub(crate) own_memory: bool,
    /// Cores that a real-time thread of it keeps busy: none or one.
    pub(crate) cores: usize,
    /// Injects it once.
    pub(crate) inject: fn(&mut Trial) -> Result<(), String>,
}

type Inject = fn(&mut Trial) -> Result<(), String>;

const fn goes_on(name: &'static str, about: &'static str, inject: Inject) -> Cause {
    Cause {
        name,
        about,
        expected: Expected::GoesOn,
        bound: "",
        own_memory: false,
        cores: 0,
        inject,
    }
}

const fn halts(name: &'static str, about: &'static str, bound: &'static str, inject: Inject) -> Cause {
    Cause {
        name,
        about,
        expected: Expected::Halt,
        bound,
        own_memory: false,
        cores: 0,
        inject,
    }
}

const fn keeping_a_core(cause: Cause) -> Cause {
    Cause { cores: 1, ..cause }
}

const APART: &str = "the body's stale limit + 1 period";

/// Every cause, in the order of the report.
pub(crate) static CAUSES: &[Cause] = &[
    goes_on("layer-kill", "a layer process dies by SIGKILL", |t| {
        layers::dies(t, Signal::KILL)
    }),
    goes_on("layer-abort", "a layer process dies by SIGABRT", |t| {
        layers::dies(t, Signal::ABORT)
    }),
    goes_on("layer-panic", "a layer process panics", |t| {
        layers::ends(t, Behaviour::Panic)
    }),
    goes_on("layer-exit", "a layer process leaves without a word", |t| {
        layers::ends(t, Behaviour::Exit)
    }),
    goes_on(
        "layer-stop",
        "a layer process freezes (SIGSTOP) and thaws",
        layers::freezes,
    ),
    goes_on(
        "layer-slow",
        "a layer process writes ten times too slowly",
        layers::slow,
    ),
    goes_on(
        "layer-flood",
        "a layer process writes as fast as it can",
        layers::floods,
    ),
    goes_on(
        "layer-garbage",
        "NaN, infinities, stamps in the future on a tap",
        layers::garbage,
    ),
    goes_on(
        "layer-scribble",
        "random bytes over a layer's own shared memory",
        layers::scribbles,
    ),
    goes_on(
        "layer-churn",
        "eight processes attach and detach in a loop",
        layers::churn,
    ),
    goes_on(
        "manifest-garbage",
        "random, endless, half, deep and silent callers",
        layers::manifest_garbage,
    ),
    halts("daemon-kill", "the daemon dies by SIGKILL", APART, |t| {
        lives::daemon_dies(t, Signal::KILL)
    }),
    halts("daemon-abort", "the daemon dies by SIGABRT", APART, |t| {
        lives::daemon_dies(t, Signal::ABORT)
    }),
    halts(
        "daemon-stop",
        "the daemon freezes (SIGSTOP) and thaws",
        APART,
        lives::daemon_freezes,
    ),
    halts(
        "inside-panic",
        "a layer inside the daemon panics",
        "the body's stale limit + 2 periods",
        lives::panics_inside,
    ),
    keeping_a_core(halts(
        "inside-loop",
        "a vital layer inside the daemon never returns",
        "50 ms of silence + 2 periods",
        lives::loops_inside,
    )),
    keeping_a_core(halts(
        "inside-overrun",
        "a layer with `overrun = \"halt\"` overruns",
        "2 of its periods + 2 periods",
        lives::overruns_inside,
    )),
    keeping_a_core(goes_on(
        "inside-skip",
        "a layer with `overrun = \"skip\"` overruns",
        lives::skips_inside,
    )),
    keeping_a_core(halts(
        "body-kill",
        "the body's process dies, another comes",
        "the pulse's stale limit + 2 periods",
        |t| lives::body_lost(t, Signal::KILL),
    )),
    keeping_a_core(halts(
        "body-stop",
        "the body's process freezes and thaws",
        "the pulse's stale limit + 2 periods",
        |t| lives::body_lost(t, Signal::STOP),
    )),
    keeping_a_core(halts(
        "emergency-stop",
        "an operator's emergency stop",
        "2 periods + 1 until the caller is heard",
        lives::emergency_stop,
    )),
    keeping_a_core(halts(
        "sigterm",
        "SIGTERM in the middle of a long step",
        "20 ms + 2 periods",
        lives::ends_in_mid_step,
    )),
    goes_on(
        "second-daemon",
        "a second daemon of the same name",
        host::second_daemon,
    ),
    goes_on(
        "clock-step",
        "the realtime clock is stepped ten times a second",
        stepped::clock_stepped,
    ),
    goes_on(
        "descriptors",
        "callers take every file descriptor",
        host::descriptors_used_up,
    ),
    goes_on(
        "memory-limit",
        "the daemon is near its memory limit (RLIMIT_AS), callers come",
        host::memory_limited,
    ),
    halts(
        "memory-out",
        "the daemon may have no more memory (RLIMIT_AS), and ends",
        APART,
        host::memory_used_up,
    ),
    Cause {
        own_memory: true,
        ..goes_on("memory-full", "/dev/shm is full", host::memory_full)
    },
];

/// The cause called `name`.
pub(crate) fn find(name: &str) -> Option<&'static Cause> {
    CAUSES.iter().find(|c| c.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_of_one_cause_each_and_halts_have_a_bound() {
        for (place, cause) in CAUSES.iter().enumerate() {
            let first = CAUSES.iter().position(|c| c.name == cause.name);
            assert_eq!(first, Some(place), "{}", cause.name);
            assert_eq!(
                cause.bound.is_empty(),
                cause.expected == Expected::GoesOn,
                "{}",
                cause.name
            );
        }
    }
}
