//! A cell: the one-message memory of a wire, written by one thread and read by any number, without waiting.
//!
//! Must never block, retry without bound or call the system. A cell lies in plain memory or in shared
//! memory; its layout is the contract between processes ([`LAYOUT`]).
//!
//! It is a sequence lock (H.-J. Boehm, "Can seqlocks get along with programming language memory
//! models?", MSPC 2012) made of atomics throughout, so that a reader racing with a writer, even a
//! malicious one, reads stale or torn numbers that it then throws away, never undefined behaviour:
//!
//! ```text
//!  writer:  sequence := odd ─ fence(release) ─ stamp, words ─ sequence := even (release)
//!  reader:  even? (acquire) ─ stamp, words ─ fence(acquire) ─ sequence unchanged?   else again, ≤ 4 times
//! ```

use super::sync::{AtomicU64, Ordering, fence};
use crate::clock::Time;
use crate::message::{Kind, WORDS_MAX, Words};

/// Version of the layout of cells and pages in shared memory; changes whenever it does.
pub const LAYOUT: u32 = 1;

/// How often a read is tried before the old value is kept: a read takes about 10 ns, so a writer at its
/// fastest (a busy loop) disturbs a few of them in a row, and then waiting would be the wrong answer.
pub const TRIES_MAX: usize = 4;

/// The one-message memory of a wire.
#[derive(Debug)]
#[repr(C, align(64))]
pub struct Cell {
    /// Twice the number of messages written; odd while one is being written.
    sequence: AtomicU64,
    /// When the newest message was written, nanoseconds on `CLOCK_MONOTONIC`.
    stamp: AtomicU64,
    /// The newest message's words, as the bits of `f64`.
    words: [AtomicU64; WORDS_MAX],
}

/// A message as read from a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// How many messages were written to the wire so far, this one included.
    pub number: u64,
    /// When it was written.
    pub stamp: Time,
    /// Its words.
    pub words: Words,
}

/// The first `N` words of a message as taken from a cell.
pub(super) struct Taken<const N: usize> {
    /// How many messages were written to the wire so far, this one included.
    pub(super) number: u64,
    /// When it was written.
    pub(super) stamp: Time,
    /// Its words.
    pub(super) words: [f64; N],
}

/// What one try to read a cell came to.
enum Attempt<const N: usize> {
    /// A whole message.
    Whole(Taken<N>),
    /// Nothing was ever written.
    Empty,
    /// A writer was at it.
    Disturbed,
}

impl Default for Cell {
    fn default() -> Self {
        Cell::new()
    }
}

impl Cell {
    /// An empty cell: nothing was ever written.
    pub fn new() -> Cell {
        Cell {
            sequence: AtomicU64::new(0),
            stamp: AtomicU64::new(0),
            words: std::array::from_fn(|_| AtomicU64::new(0)),
        }
    }

    /// Writes a message of `N` words. Only the wire's one writer may call this.
    #[inline]
    pub(super) fn put<const N: usize>(&self, stamp: Time, words: &[f64; N]) {
        // Relaxed: only this thread writes the sequence.
        let sequence = self.sequence.load(Ordering::Relaxed);
        self.sequence.store(sequence | 1, Ordering::Relaxed);
        // Pairs with the acquire fence of `take`: whoever sees a new word sees the odd sequence as well.
        fence(Ordering::Release);
        self.stamp.store(stamp.0, Ordering::Relaxed);
        for (cell, word) in self.words[..N].iter().zip(words) {
            cell.store(word.to_bits(), Ordering::Relaxed);
        }
        // Pairs with the acquire load of `take`: whoever sees the even sequence sees the words.
        self.sequence
            .store((sequence | 1).wrapping_add(1), Ordering::Release);
    }

    /// Writes a message of `kind`. Only the wire's one writer may call this.
    #[inline]
    pub(crate) fn write(&self, stamp: Time, words: &Words, kind: Kind) {
        // The lengths that there are, each as code of its own: most messages have one word.
        if kind.single() {
            return self.put(stamp, &[words[0]]);
        }
        match kind.words() {
            0 => self.put(stamp, &[]),
            2 => self.put(stamp, &[words[0], words[1]]),
            3 => self.put(stamp, &[words[0], words[1], words[2]]),
            _ => self.put(stamp, words),
        }
    }

    /// How many messages were written so far, or `None` while one is being written.
    /// A cheap look whether [`Cell::read`] is worth it.
    #[inline]
    pub fn number(&self) -> Option<u64> {
        // Acquire is not needed for a look; `read` orders itself.
        let sequence = self.sequence.load(Ordering::Relaxed);
        (sequence & 1 == 0).then_some(sequence / 2)
    }

    /// Whether the newest message may be another than number `seen`; the common answer, no, costs one load.
    #[inline]
    pub(crate) fn changed(&self, seen: u64) -> bool {
        // Acquire is not needed for a look; `take` orders itself.
        self.sequence.load(Ordering::Relaxed) != seen.wrapping_mul(2)
    }

    /// The newest message's first `N` words; `None` if there never was one or if none could be read whole in
    /// [`TRIES_MAX`] tries.
    #[inline(always)]
    pub(super) fn take<const N: usize>(&self) -> Option<Taken<N>> {
        // Pairs with the release store that ends `put`.
        let before = self.sequence.load(Ordering::Acquire);
        match self.attempt(before) {
            Attempt::Whole(taken) => Some(taken),
            Attempt::Empty => None,
            Attempt::Disturbed => self.retry(),
        }
    }

    /// As [`Cell::take`], and `None` if it is number `seen`; that, the common answer, costs one load.
    #[inline(always)]
    pub(super) fn take_newer<const N: usize>(&self, seen: u64) -> Option<Taken<N>> {
        // Pairs with the release store that ends `put`.
        let before = self.sequence.load(Ordering::Acquire);
        if before == seen.wrapping_mul(2) {
            return None;
        }
        match self.attempt(before) {
            Attempt::Whole(taken) => Some(taken),
            Attempt::Empty => None,
            Attempt::Disturbed => self.retry().filter(|taken| taken.number != seen),
        }
    }

    /// The further tries of [`Cell::take`]: rare, so kept out of the way.
    #[cold]
    fn retry<const N: usize>(&self) -> Option<Taken<N>> {
        for _ in 1..TRIES_MAX {
            super::sync::pause();
            // Pairs with the release store that ends `put`.
            match self.attempt(self.sequence.load(Ordering::Acquire)) {
                Attempt::Whole(taken) => return Some(taken),
                Attempt::Empty => return None,
                Attempt::Disturbed => {}
            }
        }
        None
    }

    /// One try, after the sequence was found to be `before`.
    #[inline(always)]
    fn attempt<const N: usize>(&self, before: u64) -> Attempt<N> {
        if before == 0 {
            return Attempt::Empty;
        }
        if before & 1 == 1 {
            return Attempt::Disturbed;
        }
        let stamp = Time(self.stamp.load(Ordering::Relaxed));
        let words = std::array::from_fn(|k| f64::from_bits(self.words[k].load(Ordering::Relaxed)));
        // Pairs with the release fence of `put`.
        fence(Ordering::Acquire);
        if self.sequence.load(Ordering::Relaxed) != before {
            return Attempt::Disturbed;
        }
        let number = before / 2;
        Attempt::Whole(Taken { number, stamp, words })
    }

    /// As [`Cell::take`], for a message of `kind`, whose words come into `words`; else those stay as they were.
    pub(crate) fn take_words(&self, kind: Kind, words: &mut [f64]) -> Option<(u64, Time)> {
        match kind.words() {
            0 => put_into::<0>(self.take(), words),
            1 => put_into::<1>(self.take(), words),
            2 => put_into::<2>(self.take(), words),
            3 => put_into::<3>(self.take(), words),
            _ => put_into::<WORDS_MAX>(self.take(), words),
        }
    }

    /// The newest message, of `kind`; `None` if there never was one, or if none could be read
    /// whole in [`TRIES_MAX`] tries (the caller keeps what it had).
    pub fn read(&self, kind: Kind) -> Option<Reading> {
        let mut words = [0.0; WORDS_MAX];
        let (number, stamp) = self.take_words(kind, &mut words)?;
        Some(Reading { number, stamp, words })
    }
}

/// Puts the words of what was taken where they belong: its number and its stamp.
#[inline(always)]
fn put_into<const N: usize>(taken: Option<Taken<N>>, words: &mut [f64]) -> Option<(u64, Time)> {
    let taken = taken?;
    words[..N].copy_from_slice(&taken.words);
    Some((taken.number, taken.stamp))
}
