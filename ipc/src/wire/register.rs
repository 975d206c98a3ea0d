//! A register: the one-element buffer behind an input port, with the suppressors that stand before it.
//!
//! Must never queue, allocate after it was built, or wait. It holds the newest message delivered; messages
//! that come faster than they are looked at overwrite each other, by design (Brooks 1991 §6.2).
//!
//! ```text
//!   existing wire ──► (S level 1) ──► (S level 1, declared later) ──► (S level 2) ──► register ──► module
//! ```

use std::sync::Arc;

use super::joined::{
    Fate, Joined, Plug, TapEnd, TapGauge, TapLook, TapState, join, plausible, release, sweep, window_of,
};
use super::limits::Limits;
use super::page::Reader;
use crate::clock::Time;
use crate::message::{Kind, Payload, WORDS_MAX, Words};
use crate::tap::{self, Window};

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
///
/// It is two lines of the processor's cache: with a thousand modules a beat waits for memory, not for arithmetic.
/// Only messages of several words, which are rare, lie elsewhere.
#[derive(Debug)]
#[repr(C, align(64))]
pub struct Register {
    wire: Option<Reader>,
    seen: u64,
    low: f64,
    high: f64,
    kind: Kind,
    /// Whether a message is held.
    holds: bool,
    /// Whether a message was delivered since the last gather.
    pending: bool,
    arrived: bool,
    /// What became of the existing wire's message at the last look, if there was one: number `seen`.
    looked: Option<Fate>,
    /// Whether that message is the one after the last that was looked at.
    next: bool,
    /// The stamp of the message held.
    stamp: Time,
    /// The message held, if it is of a kind of one word.
    word: f64,
    /// The message held, if it is of another kind.
    words: Option<Box<Words>>,
    taps: Vec<Joined>,
    counts: InputCounts,
}

const _: () = assert!(size_of::<Register>() == 128);

/// What a register took in of its wire at its last look, in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Took {
    /// Nothing.
    Nothing,
    /// The message after the last one that it took in, which was delivered.
    Next,
    /// What [`Register::looked`] tells.
    Other,
}

/// A message that may be let in: the existing wire's, or that of the k-th tap.
#[derive(Clone, Copy)]
enum From {
    Wire,
    Tap(usize),
}

impl Register {
    /// A register for messages within `limits`, fed by `wire` if the port is connected.
    pub fn new(limits: Limits, wire: Option<Reader>) -> Register {
        Register {
            low: limits.low.max(f64::MIN),
            high: limits.high.min(f64::MAX),
            kind: limits.kind,
            wire,
            seen: 0,
            taps: Vec::new(),
            holds: false,
            pending: false,
            arrived: false,
            looked: None,
            next: false,
            counts: InputCounts::default(),
            stamp: Time::ZERO,
            word: 0.0,
            words: (!limits.kind.single()).then(|| Box::new([0.0; WORDS_MAX])),
        }
    }

    /// Connects the port to another wire from now on, and hands back the one before: whoever wrote that is gone,
    /// and has come back with new ones. The message held stays until a newer one is delivered. A wire that carries
    /// something else is handed back itself.
    pub fn connect(&mut self, wire: Reader) -> Option<Reader> {
        if wire.kind() != self.kind {
            return Some(wire);
        }
        self.seen = 0;
        self.wire.replace(wire)
    }

    /// Joins a suppressor: after those of lower or equal level, before those of higher level. Does not
    /// allocate if the tap brings [`Room::full`](super::Room::full). `Err` gives the tap back when
    /// [`TAPS_MAX`](super::TAPS_MAX) stand there already.
    pub fn suppress(&mut self, end: TapEnd) -> Result<(), TapEnd> {
        join(&mut self.taps, end)
    }

    /// Tells the suppressors of `plug` to go. Their windows still run out as they would have.
    pub fn release(&mut self, plug: Plug) {
        release(&mut self.taps, plug);
    }

    /// Looks at the wire and the taps, once a beat, before the module steps. `gone` is handed each tap that
    /// has left for good, to be dropped on a thread that may.
    #[inline]
    pub fn gather(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        self.look(now, gone);
        self.arrived = std::mem::take(&mut self.pending);
    }

    /// Looks at the wire and the taps between two beats. What is delivered counts as arrived at the next
    /// [`Register::gather`]. In real time nobody does this: messages that come faster than the beat
    /// overwrite each other. On the virtual clock it lets every message meet the rules, not only the newest.
    #[inline]
    pub fn look(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        // Most messages are one word: those never touch the other eleven.
        if self.kind.single() {
            self.look_at::<1>(now, gone);
        } else {
            self.look_at_many(now, gone);
        }
    }

    /// [`Register::look`] for messages of several words: rare, so kept out of the way.
    #[inline(never)]
    fn look_at_many(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        self.look_at::<WORDS_MAX>(now, gone);
    }

    /// [`Register::look`] for messages of up to `N` words.
    #[inline(always)]
    fn look_at<const N: usize>(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        let mut incoming = [0.0; N];
        let original = self.newest_original(now, &mut incoming);
        if self.taps.is_empty() {
            if let Some(stamp) = original {
                self.deliver(stamp, &incoming);
            }
            return;
        }
        let mut fresh = false;
        let limits = self.limits();
        for tap in &mut self.taps {
            tap.look(now, Some(&limits));
            fresh |= tap.fresh;
        }
        if fresh {
            self.series(original, &incoming);
        } else if let Some(stamp) = original {
            // No tap spoke: what it decides hangs on the windows alone.
            if self.passes_from(0, stamp) {
                self.deliver(stamp, &incoming);
            } else {
                self.counts.rejected += 1;
                self.looked = Some(Fate::Rejected);
            }
        }
        sweep(&mut self.taps, now, gone);
    }

    /// Lets in the newest message of the series, in a beat in which at least one tap spoke. `original` is the
    /// stamp of the existing wire's message, if one came, and `incoming` its words.
    fn series<const N: usize>(&mut self, original: Option<Time>, incoming: &[f64; N]) {
        let in_hindsight = self.rejected_in_hindsight();
        if in_hindsight {
            self.holds = false;
        }
        let mut newest = None;
        if let Some(stamp) = original {
            if self.passes_from(0, stamp) {
                newest = Some((stamp, From::Wire));
            } else {
                self.counts.rejected += 1;
                self.looked = Some(Fate::Rejected);
            }
        }
        for k in 0..self.taps.len() {
            let (fresh, Some(window)) = (self.taps[k].fresh, self.taps[k].window) else {
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
                    newest = Some((window.stamp, From::Tap(k)));
                }
            }
        }
        match newest {
            Some((stamp, From::Wire)) => self.deliver(stamp, incoming),
            Some((stamp, From::Tap(k))) => {
                let mut words = [0.0; N];
                words.copy_from_slice(&self.taps[k].words[..N]);
                self.deliver(stamp, &words);
            }
            None => {}
        }
    }

    /// Whether a tap's message that came in just now was written before the message held, and its window
    /// rejects that: another process may stamp a message and be held up before it writes it. The register
    /// must not keep a message that its suppressor overrules for as long as the window is open; what it
    /// holds instead is the newest message of the taps.
    fn rejected_in_hindsight(&self) -> bool {
        if !self.holds {
            return false;
        }
        let held = self.stamp;
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

    /// The stamp of the existing wire's newest message, if it was not seen before and is one; its words are
    /// then those `incoming`.
    #[inline(always)]
    fn newest_original<const N: usize>(&mut self, now: Time, incoming: &mut [f64; N]) -> Option<Time> {
        self.looked = None;
        let (number, stamp) = self.wire.as_ref()?.take_newer(self.seen, incoming)?;
        self.next = number.wrapping_sub(self.seen) == 1;
        self.seen = number;
        match plausible(stamp, now) {
            Some(stamp) if self.limits().accept(incoming) => {
                self.looked = Some(Fate::Delivered);
                Some(stamp)
            }
            _ => {
                self.looked = Some(Fate::Fault);
                self.counts.faults += 1;
                None
            }
        }
    }

    /// Whether a message stamped `u` gets through the suppressors from the `first` on; counts it with the
    /// one that rejects it.
    #[inline]
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

    #[inline]
    fn deliver<const N: usize>(&mut self, stamp: Time, words: &[f64; N]) {
        self.counts.delivered += 1;
        // Writes of other threads may be seen out of order: what is older than the message held was
        // overwritten by it.
        if self.holds && stamp < self.stamp {
            return;
        }
        match &mut self.words {
            None => self.word = words[0],
            Some(all) => all[..N].copy_from_slice(words),
        }
        self.stamp = stamp;
        self.holds = true;
        self.pending = true;
    }

    /// The message held, with its stamp; `None` until the first was delivered.
    #[inline]
    pub fn held(&self) -> Option<(Time, Words)> {
        let words = || match &self.words {
            Some(words) => **words,
            None => std::array::from_fn(|k| if k == 0 { self.word } else { 0.0 }),
        };
        self.holds.then(|| (self.stamp, words()))
    }

    /// What the message held says; `None` until the first was delivered, and from a register whose messages have another
    /// number of words.
    #[inline]
    pub fn value<T: Payload>(&self) -> Option<T> {
        if !self.holds {
            return None;
        }
        match &self.words {
            None if T::KIND.single() => Some(T::of_word(self.word)),
            Some(words) if !T::KIND.single() => Some(T::unpack(words)),
            _ => None,
        }
    }

    /// When the message held was written; `None` until the first was delivered.
    #[inline]
    pub fn stamp(&self) -> Option<Time> {
        self.holds.then_some(self.stamp)
    }

    #[inline(always)]
    fn limits(&self) -> Limits {
        Limits {
            kind: self.kind,
            low: self.low,
            high: self.high,
        }
    }

    /// Whether a message was delivered at the last [`Register::gather`].
    #[inline]
    pub fn arrived(&self) -> bool {
        self.arrived
    }

    /// Whether a suppressor stands before it.
    #[inline]
    pub fn tapped(&self) -> bool {
        !self.taps.is_empty()
    }

    /// What the last [`Register::gather`] took in of the existing wire, in a word, for those who trace.
    #[inline]
    pub fn took(&self) -> Took {
        match self.looked {
            None => Took::Nothing,
            Some(Fate::Delivered) if self.next => Took::Next,
            _ => Took::Other,
        }
    }

    /// The message of the existing wire that the last [`Register::gather`] took in, by its number, and what
    /// became of it; for those who trace.
    pub fn looked(&self) -> Option<(u64, Fate)> {
        self.looked.map(|fate| (self.seen, fate))
    }

    /// The number of the last message of the existing wire that was looked at, 0 if there was none.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The messages of taps that the last [`Register::gather`] took in, for those who trace.
    pub fn tap_looks(&self) -> impl Iterator<Item = TapLook<'_>> {
        self.taps.iter().filter_map(Joined::look_taken)
    }

    /// Forgets the message held: what a reset line does.
    pub fn clear(&mut self) {
        self.holds = false;
        self.pending = false;
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

    /// The window of the tap that is counted at `gauge`; `None` if it is not joined here or said nothing yet.
    pub fn window_of(&self, gauge: &Arc<TapGauge>) -> Option<Window> {
        window_of(&self.taps, gauge)
    }
}
