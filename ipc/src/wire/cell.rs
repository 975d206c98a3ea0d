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
use crate::message::{WORDS_MAX, Words};

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

    /// Writes a message of `length` words. Only the wire's one writer may call this.
    pub(crate) fn write(&self, stamp: Time, words: &Words, length: usize) {
        // Relaxed: only this thread writes the sequence.
        let sequence = self.sequence.load(Ordering::Relaxed);
        self.sequence.store(sequence | 1, Ordering::Relaxed);
        // Pairs with the acquire fence of `read`: whoever sees a new word sees the odd sequence as well.
        fence(Ordering::Release);
        self.stamp.store(stamp.0, Ordering::Relaxed);
        for (cell, word) in self.words.iter().zip(words).take(length) {
            cell.store(word.to_bits(), Ordering::Relaxed);
        }
        // Pairs with the acquire load of `read`: whoever sees the even sequence sees the words.
        self.sequence
            .store((sequence | 1).wrapping_add(1), Ordering::Release);
    }

    /// How many messages were written so far, or `None` while one is being written.
    /// A cheap look whether [`Cell::read`] is worth it.
    pub fn number(&self) -> Option<u64> {
        // Acquire is not needed for a look; `read` orders itself.
        let sequence = self.sequence.load(Ordering::Relaxed);
        (sequence & 1 == 0).then_some(sequence / 2)
    }

    /// The newest message of `length` words; `None` if there never was one, or if none could be read
    /// whole in [`TRIES_MAX`] tries (the caller keeps what it had).
    pub fn read(&self, length: usize) -> Option<Reading> {
        for _ in 0..TRIES_MAX {
            // Pairs with the release store that ends `write`.
            let before = self.sequence.load(Ordering::Acquire);
            if before == 0 {
                return None;
            }
            if before & 1 == 1 {
                super::sync::pause();
                continue;
            }
            let stamp = Time(self.stamp.load(Ordering::Relaxed));
            let mut words = [0.0; WORDS_MAX];
            for (word, cell) in words.iter_mut().zip(&self.words).take(length) {
                *word = f64::from_bits(cell.load(Ordering::Relaxed));
            }
            // Pairs with the release fence of `write`.
            fence(Ordering::Acquire);
            if self.sequence.load(Ordering::Relaxed) == before {
                return Some(Reading {
                    number: before / 2,
                    stamp,
                    words,
                });
            }
        }
        None
    }
}
