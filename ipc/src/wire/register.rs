//! A register: the one-element buffer behind an input port, with the suppressors that stand before it.
//!
//! Must never queue, allocate after it was built, or wait. It holds the newest message delivered; messages
//! that come faster than they are looked at overwrite each other, by design (Brooks 1991 §6.2).
//!
//! ```text
//!   existing wire ──► (S level 1) ──► (S level 1, declared later) ──► (S level 2) ──► register ──► module
//! ```

use std::mem::offset_of;
use std::sync::Arc;

use super::gauge::TapGauge;
use super::joined::{Fate, Joined, Plug, TapEnd, TapLook, TapState, join, plausible, release, window_of};
use super::limits::Limits;
use super::page::Reader;
use crate::clock::Time;
use crate::message::{Kind, Payload, WORDS_MAX, Words};
use crate::tap::Window;

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
/// With a thousand modules a beat waits for memory, not for arithmetic: so all that a port without taps needs of its
/// register at a message of one word is one line of the processor's cache, up to the wire's cell in `wire`. Only
/// messages of several words, which are rare, lie elsewhere.
#[derive(Debug)]
#[repr(C, align(64))]
pub struct Register {
    low: f64,
    high: f64,
    /// The stamp of the message held; zero while there is none.
    pub(super) stamp: Time,
    /// The message held, if it is of a kind of one word.
    word: f64,
    seen: u64,
    delivered: u64,
    kind: Kind,
    /// Whether messages are of one word.
    single: bool,
    /// Whether a suppressor stands before it.
    pub(super) tapped: bool,
    /// Whether a message is held.
    pub(super) holds: bool,
    /// Whether a message was delivered since the last gather.
    pending: bool,
    arrived: bool,
    /// What the last look took in of the existing wire: message number `seen`.
    pub(super) looked: Looked,
    wire: Reader,
    pub(super) taps: Vec<Joined>,
    /// The message held, if it is of another kind.
    words: Option<Box<Words>>,
    pub(super) rejected: u64,
    faults: u64,
}

const _: () = assert!(size_of::<Register>() == 128 && offset_of!(Register, wire) == 56);

/// What a look took in of the existing wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looked {
    /// One that was delivered, not the one after the last that was taken in.
    Delivered,
    /// The message after the last that was taken in, which was delivered.
    Next,
    Nothing,
    Rejected,
    Fault,
}

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

impl Register {
    /// A register for messages within `limits`, fed by `wire` if the port is connected.
    pub fn new(limits: Limits, wire: Option<Reader>) -> Register {
        let single = limits.kind.single();
        let (low, high) = match limits.kind {
            Kind::Bit => (0.0, 1.0),
            _ => (limits.low.max(f64::MIN), limits.high.min(f64::MAX)),
        };
        Register {
            low,
            high,
            stamp: Time::ZERO,
            word: 0.0,
            seen: 0,
            delivered: 0,
            kind: limits.kind,
            single,
            tapped: false,
            holds: false,
            pending: false,
            arrived: false,
            looked: Looked::Nothing,
            wire: wire.unwrap_or_else(|| Reader::silent(limits.kind)),
            taps: Vec::new(),
            words: (!single).then(|| Box::new([0.0; WORDS_MAX])),
            rejected: 0,
            faults: 0,
        }
    }

    /// Connects the port to another wire from now on, and hands back the one before: whoever wrote that is gone,
    /// and has come back with new ones. The message held stays until a newer one is delivered. A wire that carries
    /// something else is handed back itself.
    pub fn connect(&mut self, wire: Reader) -> Reader {
        if wire.kind() != self.kind {
            return wire;
        }
        self.seen = 0;
        std::mem::replace(&mut self.wire, wire)
    }

    /// Joins a suppressor: after those of lower or equal level, before those of higher level. Does not
    /// allocate if the tap brings [`Room::full`](super::Room::full). `Err` gives the tap back when
    /// [`TAPS_MAX`](super::TAPS_MAX) stand there already.
    pub fn suppress(&mut self, end: TapEnd) -> Result<(), TapEnd> {
        join(&mut self.taps, end)?;
        self.tapped = true;
        Ok(())
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
        // Most messages are one word, and most taps say nothing: those never touch the other eleven words.
        if !self.single {
            return self.look_at_words(now, gone);
        }
        let original = self.original_word(now);
        if self.tapped && !self.quiet(original.map(|(stamp, _)| stamp)) {
            let original = original.map(|(stamp, word)| (stamp, [word]));
            self.look_at_taps(original, now, gone);
        } else if let Some((stamp, word)) = original {
            self.deliver(stamp, &[word]);
        }
    }

    /// [`Register::look`] for messages of several words: rare.
    #[inline(never)]
    fn look_at_words(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        let original = self.original_words(now);
        if self.tapped {
            self.look_at_taps(original, now, gone);
        } else if let Some((stamp, words)) = original {
            self.deliver(stamp, &words);
        }
    }

    /// The existing wire's newest message, of one word, if it was not seen before and is one.
    #[inline(always)]
    fn original_word(&mut self, now: Time) -> Option<(Time, f64)> {
        let Some((number, stamp, word)) = self.wire.take_word_newer(self.seen) else {
            self.looked = Looked::Nothing;
            return None;
        };
        let within = self.low <= word && word <= self.high && (self.kind == Kind::Number || is_bit(word));
        if within && let Some(stamp) = plausible(stamp, now) {
            self.accept(number);
            return Some((stamp, word));
        }
        self.refuse(number);
        None
    }

    /// The existing wire's newest message, of several words, if it was not seen before and is one.
    fn original_words(&mut self, now: Time) -> Option<(Time, Words)> {
        let mut words = [0.0; WORDS_MAX];
        let Some((number, stamp)) = self.wire.take_newer(self.seen, &mut words) else {
            self.looked = Looked::Nothing;
            return None;
        };
        if self.limits().accept(&words)
            && let Some(stamp) = plausible(stamp, now)
        {
            self.accept(number);
            return Some((stamp, words));
        }
        self.refuse(number);
        None
    }

    /// Notes that message `number` of the existing wire was looked at, and is one.
    #[inline(always)]
    fn accept(&mut self, number: u64) {
        let next = number.wrapping_sub(self.seen) == 1;
        self.looked = if next { Looked::Next } else { Looked::Delivered };
        self.seen = number;
    }

    /// Notes that message `number` of the existing wire was looked at, and is none.
    #[cold]
    fn refuse(&mut self, number: u64) {
        self.looked = Looked::Fault;
        self.seen = number;
        self.faults += 1;
    }

    #[inline]
    pub(super) fn deliver<const N: usize>(&mut self, stamp: Time, words: &[f64; N]) {
        self.delivered += 1;
        // Writes of other threads may be seen out of order: what is older than the message held was
        // overwritten by it.
        if stamp < self.stamp {
            return;
        }
        if N == 1 {
            self.word = words[0];
        } else if let Some(all) = &mut self.words {
            all[..N].copy_from_slice(words);
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

    /// What the message held said; `None` until the first was delivered, and from a register whose messages have another
    /// number of words.
    #[inline]
    pub fn value<T: Payload>(&self) -> Option<T> {
        if !self.holds || self.single != T::KIND.single() {
            return None;
        }
        if T::KIND.single() {
            return Some(T::of_word(self.word));
        }
        self.words.as_deref().map(T::unpack)
    }

    /// When the message held was written; `None` until the first was delivered.
    #[inline]
    pub fn stamp(&self) -> Option<Time> {
        self.holds.then_some(self.stamp)
    }

    #[inline(always)]
    pub(super) fn limits(&self) -> Limits {
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
        self.tapped
    }

    /// What the last [`Register::gather`] took in of the existing wire, in a word, for those who trace.
    #[inline]
    pub fn took(&self) -> Took {
        match self.looked {
            Looked::Nothing => Took::Nothing,
            Looked::Next => Took::Next,
            _ => Took::Other,
        }
    }

    /// The message of the existing wire that the last [`Register::gather`] took in, by its number, and what
    /// became of it; for those who trace.
    pub fn looked(&self) -> Option<(u64, Fate)> {
        let fate = match self.looked {
            Looked::Nothing => return None,
            Looked::Next | Looked::Delivered => Fate::Delivered,
            Looked::Rejected => Fate::Rejected,
            Looked::Fault => Fate::Fault,
        };
        Some((self.seen, fate))
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
        self.forget();
        self.pending = false;
        self.arrived = false;
    }

    /// Holds no message any more.
    pub(super) fn forget(&mut self) {
        self.holds = false;
        self.stamp = Time::ZERO;
    }

    /// What was counted so far.
    pub fn counts(&self) -> InputCounts {
        InputCounts {
            delivered: self.delivered,
            rejected: self.rejected,
            faults: self.faults,
        }
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

/// Whether a number is one that stands for a bit.
#[inline(never)]
fn is_bit(word: f64) -> bool {
    word == 0.0 || word == 1.0
}
