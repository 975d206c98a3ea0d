//! Panics: the body is halted before a word is said about one.
//!
//! A panic ends the process, and the body's own gate closes when commands go stale. But the message comes first, with
//! a backtrace where one is asked for, on a standard error that perhaps nobody reads: until it is written, for tens
//! of milliseconds or for ever, the threads that did not panic go on. So the gate is closed before: it latches
//! *panic*, and the process leaves, with its message or without.
//!
//! Must never keep a panic from ending the process.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::executor::host;

static PANICKED: AtomicBool = AtomicBool::new(false);

/// Whether a thread of this process has panicked since [`guard`].
pub fn any() -> bool {
    // Relaxed: a bit to look at.
    PANICKED.load(Ordering::Relaxed)
}

/// From now on a panic is known before it is reported, in whatever way it was reported so far.
pub fn guard() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        PANICKED.store(true, Ordering::Relaxed);
        // A backtrace takes tens of milliseconds: at a real-time priority they would be everybody else's on this host.
        let _ = host::be_ordinary();
        report(info);
    }));
}
