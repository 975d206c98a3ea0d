//! A register: the one-element buffer behind an input port, with the suppressors that stand before it.
//!
//! Must never queue, allocate after it was built, or wait. It holds the newest message delivered; messages
//! that come faster than they are looked at overwrite each other, by design (Brooks 1991 §6.2).
//!
//! ```text
//!   existing wire ──► (S level 1) ──► (S level 1, declared later) ──► (S level 2) ──► register ──► module
//! ```

use super::page::Reader;
use super::side_tap::{
    Fate, Joined, Plug, TAPS_MAX, TapEnd, TapLook, TapState, join, plausible, release, sweep,
};
use crate::clock::Time;
use crate::message::{Kind, Words};
use crate::tap;

/// What an input port takes: kind and range of every number.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The kind of message.
    pub kind: Kind,
    /// Smallest value of any number in it.
    pub low: f64,
    /// Largest value of any number in it.
    pub high: f64,
}

impl Limits {
    pub(super) fn accept(&self, words: &Words) -> bool {
        self.kind.accepts(words, self.low, self.high)
    }
}

/// What was counted at one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputCounts {
    /// Messages delivered to the register, from the wire or a tap.
    pub delivered: u64,
    /// Messages of the existing wire that a suppressor rejected.
    pub rejected: u64,
    /// Messages that were no message (not a number, out of range, stamped in the future).
    pub faults: u64,
}

/// The register behind one input port.
#[derive(Debug)]
pub struct Register {
    limits: Limits,
    wire: Option<Reader>,
    seen: u64,
    taps: Vec<Joined>,
    held: Option<(Time, Words)>,
    arrived: bool,
    looked: Option<(u64, Fate)>,
    counts: InputCounts,
}

impl Register {
    /// A register for messages within `limits`, fed by `wire` if the port is connected.
    pub fn new(limits: Limits, wire: Option<Reader>) -> Register {
        Register {
            limits,
            wire,
            seen: 0,
            taps: Vec::with_capacity(TAPS_MAX),
            held: None,
            arrived: false,
            looked: None,
            counts: InputCounts::default(),
        }
    }

    /// Joins a suppressor: after those of lower or equal level, before those of higher level. Does not
    /// allocate. `Err` gives the tap back when [`TAPS_MAX`] stand there already.
    pub fn suppress(&mut self, end: TapEnd) -> Result<(), TapEnd> {
        join(&mut self.taps, end)
    }

    /// Tells the suppressors of `plug` to go. Their windows still run out as they would have.
    pub fn release(&mut self, plug: Plug) {
        release(&mut self.taps, plug);
    }

    /// Looks at the wire and the taps, once a beat, before the module steps. `gone` is handed each tap that
    /// has left for good, to be dropped on a thread that may.
    pub fn gather(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        self.arrived = false;
        self.looked = None;
        let original = self.look(now);
        if self.taps.is_empty() {
            if let Some((stamp, words)) = original {
                self.deliver(stamp, words);
            }
            return;
        }
        for tap in &mut self.taps {
            tap.look(now, Some(&self.limits));
        }
        let in_hindsight = self.rejected_in_hindsight();
        if in_hindsight {
            self.held = None;
        }
        let mut newest = None;
        if let Some((stamp, words)) = original {
            if self.passes_from(0, stamp) {
                newest = Some((stamp, words));
            } else {
                self.counts.rejected += 1;
                self.looked = self.looked.map(|(number, _)| (number, Fate::Rejected));
            }
        }
        for k in 0..self.taps.len() {
            let Joined {
                fresh,
                window: Some(window),
                words,
                ..
            } = self.taps[k]
            else {
                continue;
            };
            let passes = if fresh {
                self.passes_from(k + 1, window.stamp)
            } else {
                // Looked at before, and counted then.
                let above = &self.taps[k + 1..];
                in_hindsight && tap::passes(window.stamp, above.iter().filter_map(|t| t.window))
            };
            if passes {
                if fresh {
                    self.taps[k].take_effect();
                }
                if newest.is_none_or(|(stamp, _)| window.stamp >= stamp) {
                    newest = Some((window.stamp, words));
                }
            }
        }
        if let Some((stamp, words)) = newest {
            self.deliver(stamp, words);
        }
        sweep(&mut self.taps, now, gone);
    }

    /// Whether a tap's message that came in just now was written before the message held, and its window
    /// rejects that: another process may stamp a message and be held up before it writes it. The register
    /// must not keep a message that its suppressor overrules for as long as the window is open; what it
    /// holds instead is the newest message of the taps.
    fn rejected_in_hindsight(&self) -> bool {
        let Some((held, _)) = self.held else {
            return false;
        };
        // A message of a tap that stands further along is not the lower tap's to reject.
        let from = self
            .taps
            .iter()
            .rposition(|t| t.window.is_some_and(|w| w.stamp == held) && !t.fresh)
            .map_or(0, |k| k + 1);
        let above = &self.taps[from..];
        above
            .iter()
            .any(|t| t.fresh && t.window.is_some_and(|w| w.holds(held)))
    }

    /// The newest message of the existing wire, if it was not seen before and is one.
    fn look(&mut self, now: Time) -> Option<(Time, Words)> {
        let reading = self.wire.as_ref()?.newer_than(self.seen)?;
        self.seen = reading.number;
        match plausible(reading.stamp, now) {
            Some(stamp) if self.limits.accept(&reading.words) => {
                self.looked = Some((reading.number, Fate::Delivered));
                Some((stamp, reading.words))
            }
            _ => {
                self.looked = Some((reading.number, Fate::Fault));
                self.counts.faults += 1;
                None
            }
        }
    }

    /// Whether a message stamped `u` gets through the suppressors from the `first` on; counts it with the
    /// one that rejects it.
    fn passes_from(&mut self, first: usize, u: Time) -> bool {
        let above = &mut self.taps[first..];
        if tap::passes(u, above.iter().filter_map(|t| t.window)) {
            return true;
        }
        if let Some(tap) = above.iter_mut().rfind(|t| t.window.is_some_and(|w| w.holds(u))) {
            tap.reject();
        }
        false
    }

    fn deliver(&mut self, stamp: Time, words: Words) {
        self.counts.delivered += 1;
        // Writes of other threads may be seen out of order: what is older than the message held was
        // overwritten by it.
        if self.held.is_none_or(|(held, _)| stamp >= held) {
            self.held = Some((stamp, words));
            self.arrived = true;
        }
    }

    /// The message held, with its stamp; `None` until the first was delivered.
    pub fn held(&self) -> Option<&(Time, Words)> {
        self.held.as_ref()
    }

    /// Whether a message was delivered at the last [`Register::gather`].
    pub fn arrived(&self) -> bool {
        self.arrived
    }

    /// The message of the existing wire that the last [`Register::gather`] took in, by its number, and what
    /// became of it; for those who trace.
    pub fn looked(&self) -> Option<(u64, Fate)> {
        self.looked
    }

    /// The messages of taps that the last [`Register::gather`] took in, for those who trace.
    pub fn tap_looks(&self) -> impl Iterator<Item = TapLook<'_>> {
        self.taps.iter().filter_map(Joined::look_taken)
    }

    /// Forgets the message held: what a reset line does.
    pub fn clear(&mut self) {
        self.held = None;
        self.arrived = false;
    }

    /// What was counted so far.
    pub fn counts(&self) -> InputCounts {
        self.counts
    }

    /// The taps as they stand in series, for those who watch.
    pub fn taps(&self) -> impl Iterator<Item = TapState> {
        self.taps.iter().map(Joined::state)
    }
}
