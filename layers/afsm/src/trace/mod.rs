//! Traces: what a beat saw and what it wrote, so that the beat can be run again, exactly.
//!
//! Must never make the beating thread wait, allocate or call anything: a beat is put together in a buffer of its
//! own and handed over whole, or counted as lost when the other side is behind.
//!
//! A beat's outcome hangs on three things that stamps alone do not tell: the two times that it was handed, and
//! which message each register found, for the wire may have been written while the beat was under way. So the
//! trace names every message that was taken in, by its number on its wire, and what was written, in full.
//!
//! Whoever fetches a beat gets it as
//!
//! ```text
//!   header: tag, length │ number of the beat │ time of the step │ time of the commit │ entries …
//!   entry:  tag 8 │ slot 16 │ words 4 │ number 36 bits, then what the tag says
//! ```
//!
//! What a beat nearly always has to say is shorter on the way: that a register took in the message after its last,
//! and that an outlet wrote the message after its last, is one bit each, and the message's words. Anything else is an
//! entry. So the other side has to count: the first beat tells it the last number of every slot, and so does the first
//! after a beat that was lost.
//!
//! ```text
//!   header: tag 8 │ words of entries 28 │ words in all 28 bits │ number │ step │ commit
//!   a bit for each register │ a bit for each outlet │ words of the messages written, by outlet │ entries …
//! ```

mod entry;
mod fetched;
mod ports;
#[cfg(test)]
mod tests;
mod tracer;

use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use ipc::clock::Span;
use ipc::message::WORDS_MAX;
use rtrb::RingBuffer;

pub use entry::{Entry, TracedBeat, decode, times};
pub use fetched::Trace;
pub use tracer::Tracer;

/// Most words of trace waiting for the recorder, for one thread: 2 MiB, half a second of a layer that writes 500
/// numbers a beat at 1 kHz.
pub const TRACE_WORDS_MAX: usize = 1 << 18;

/// Fewest: a few seconds of a small layer at 100 Hz.
const TRACE_WORDS_MIN: usize = 1 << 12;

/// How long the recorder may be kept from running before beats are lost.
const BEHIND: Span = Span::millis(500);

/// Room for taps that join, leave and speak within one beat, in words.
const TAP_WORDS_MAX: usize = 1024;

/// Words before the entries.
const HEADER: usize = 4;

const BEAT: u64 = 1;
const SAW: u64 = 2;
const TAP: u64 = 5;
const JOINED: u64 = 8;
const RELEASED: u64 = 9;
const WROTE: u64 = 10;
const DROPPED: u64 = 11;
const CAUSES: u64 = 12;
const PASSED: u64 = 13;

/// On the way alone: the number of a register's last message, and of an outlet's, which has so many words.
const LAST_SEEN: u64 = 14;
const LAST_WROTE: u64 = 15;

/// Numbers of messages are kept to 36 bits: two years at 1 kHz.
const NUMBER_MAX: u64 = (1 << 36) - 1;

/// Lengths on the way are kept to 28 bits.
const LENGTH_MAX: u64 = (1 << 28) - 1;

/// Slots to a word of bits.
const SLOTS_MAX: usize = 64;

/// A trace for a thread that beats once a `period` and has so many registers and outlets.
pub fn trace(period: Span, registers: usize, outlets: usize) -> (Tracer, Trace) {
    let bits = registers.div_ceil(SLOTS_MAX) + outlets.div_ceil(SLOTS_MAX);
    let beat = HEADER + bits + 2 * registers + outlets * (2 + WORDS_MAX) + TAP_WORDS_MAX;
    // As a rule a beat writes short messages.
    let usual = HEADER + bits + 2 * outlets;
    let beats = BEHIND.0.div_ceil(period.0.max(1)) as usize;
    let words = usual
        .saturating_mul(beats)
        .clamp(TRACE_WORDS_MIN, TRACE_WORDS_MAX);
    let (mut ring, mut out) = RingBuffer::new(words.max(2 * beat));
    // Touch all of it: no beat is to be the first.
    while ring.push(1).is_ok() {}
    while out.pop().is_ok() {}
    let lost = Arc::new(AtomicU64::new(0));
    let tracer = Tracer::new(ring, (registers, outlets), beat, lost.clone());
    (tracer, Trace::new(out, (registers, outlets), lost))
}

/// An entry's first word.
fn head(tag: u64, slot: usize, count: usize, number: u64) -> u64 {
    tag << 56 | (slot as u64 & 0xffff) << 40 | (count as u64) << 36 | number & NUMBER_MAX
}
