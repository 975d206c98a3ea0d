//! Side-taps: suppression and inhibition as pure functions of message stamps.
//!
//! Must never read a clock, keep state or know where a message is stored. The rules are those of
//! Brooks 1991 §6.2, made exact:
//!
//! ```text
//!             level k ── message at t ──┐ τ                      ┌── message at t, τ
//!                                       ▼                        ▼
//!   existing wire ── message at u ────►(S)──► input     output ─(I)──► existing wire
//!
//!   suppress:  the tap's message is delivered;      inhibit:  nothing is delivered;
//!              existing ones with t ≤ u < t+τ                 the output's with t ≤ u < t+τ
//!              are rejected, at u = t+τ they pass             are dropped, at u = t+τ they pass
//! ```
//!
//! *Suppression is decided where a register is read, inhibition where an output is written.* Both can be
//! decided from the newest stamp of each wire alone: every further message on a tap starts its window
//! again, so an older one can only matter for messages that a newer one outlives anyway.

use crate::clock::{Span, Time};

/// The window that a tap's newest message holds open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// When the tap's newest message was written to its wire.
    pub stamp: Time,
    /// The tap's time constant τ; longer than zero.
    pub time_constant: Span,
}

impl Window {
    /// Whether a message written at `u` falls into the window: t ≤ u < t+τ.
    #[inline]
    pub fn holds(self, u: Time) -> bool {
        self.stamp <= u && u.since(self.stamp) < self.time_constant
    }

    /// How much of the window is left at `now`; zero when it has run out or has not begun.
    pub fn remaining(self, now: Time) -> Span {
        if self.holds(now) {
            (self.stamp + self.time_constant).since(now)
        } else {
            Span::ZERO
        }
    }
}

/// Whether an output may emit a message at `u`, given the windows of all inhibitors on it.
#[inline]
pub fn emits(u: Time, inhibitors: impl IntoIterator<Item = Window>) -> bool {
    !inhibitors.into_iter().any(|window| window.holds(u))
}

/// Whether a message written at `u` gets through the suppressors that stand above its source.
///
/// `above` are the windows of the suppressors further along the wire: for a message on the existing
/// wire all of them, for one on a tap those that come later in the series (higher level, or the same
/// level and declared later).
#[inline]
pub fn passes(u: Time, above: impl IntoIterator<Item = Window>) -> bool {
    !above.into_iter().any(|window| window.holds(u))
}

/// The source whose newest message a register holds: the series evaluated from its lowest end.
///
/// `original` is the stamp of the newest message on the existing wire, `taps` the suppressors in series
/// order, each with its newest message if it ever had one. The answer is `None` if nothing was ever
/// delivered, `Some(0)` for the existing wire, `Some(k)` for the k-th suppressor (counted from 1).
pub fn holder(original: Option<Time>, taps: impl IntoIterator<Item = Option<Window>>) -> Option<usize> {
    let mut held = original.map(|stamp| (0, stamp));
    for (k, tap) in taps.into_iter().enumerate() {
        let Some(window) = tap else { continue };
        let outlived = held.is_some_and(|(_, stamp)| stamp >= window.stamp + window.time_constant);
        if !outlived {
            held = Some((k + 1, window.stamp));
        }
    }
    held.map(|(source, _)| source)
}
