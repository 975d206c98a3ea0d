//! Traces: what a beat saw and what it wrote, so that the beat can be run again, exactly.
//!
//! Must never make the beating thread wait, allocate or call anything: a beat is put together in a buffer of its
//! own and handed over whole, or counted as lost when the other side is behind.
//!
//! A beat's outcome hangs on three things that stamps alone do not tell: the two times that it was handed, and
//! which message each register found, for the wire may have been written while the beat was under way. So the
//! trace names every message that was taken in, by its number on its wire, and what was written, in full.
//!
//! ```text
//!   header: tag, length │ number of the beat │ time of the step │ time of the commit │ entries …
//!   entry:  tag 8 │ slot 16 │ words 4 │ number 36 bits, then what the tag says
//! ```

mod entry;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::{Span, Time};
use ipc::message::WORDS_MAX;
use ipc::wire::{Fate, TapLook};
use ipc::wiring::creature::How;
use rtrb::{Consumer, Producer, RingBuffer};

pub use entry::{Entry, TracedBeat, decode, times};

/// Most words of trace waiting for the recorder, for one thread: 2 MiB, half a second of a layer that takes in
/// and writes 250 messages a beat at 1 kHz.
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

/// The beating thread's end of a trace.
#[derive(Debug)]
pub struct Tracer {
    ring: Producer<u64>,
    beat: Box<[u64]>,
    used: usize,
    beats: u64,
    lost: Arc<AtomicU64>,
}

/// The recorder's end of a trace.
#[derive(Debug)]
pub struct Trace {
    ring: Consumer<u64>,
    lost: Arc<AtomicU64>,
}

/// A trace for a thread that beats once a `period` and has so many registers and outlets.
pub fn trace(period: Span, registers: usize, outlets: usize) -> (Tracer, Trace) {
    let beat = HEADER + registers + outlets * (1 + WORDS_MAX) + TAP_WORDS_MAX;
    // As a rule a beat takes in and writes short messages.
    let usual = HEADER + registers + 2 * outlets;
    let beats = BEHIND.0.div_ceil(period.0.max(1)) as usize;
    let words = usual
        .saturating_mul(beats)
        .clamp(TRACE_WORDS_MIN, TRACE_WORDS_MAX);
    let (mut ring, mut out) = RingBuffer::new(words.max(2 * beat));
    // Touch all of it: no beat is to be the first.
    while ring.push(1).is_ok() {}
    while out.pop().is_ok() {}
    let lost = Arc::new(AtomicU64::new(0));
    let tracer = Tracer {
        ring,
        beat: vec![1; beat].into(),
        used: 0,
        beats: 0,
        lost: lost.clone(),
    };
    (tracer, Trace { ring: out, lost })
}

impl Tracer {
    /// A beat begins: its modules are told that it is `now`.
    pub fn begin(&mut self, now: Time) {
        self.used = HEADER;
        self.beat[1] = self.beats;
        self.beat[2] = now.0;
        self.beats += 1;
    }

    /// The beat ends: what it wrote was stamped `now`.
    pub fn end(&mut self, now: Time) {
        let whole = self.used <= self.beat.len();
        if whole {
            self.beat[0] = BEAT << 56 | self.used as u64;
            self.beat[3] = now.0;
        }
        if !whole || self.ring.push_entire_slice(&self.beat[..self.used]).is_err() {
            // Only this thread counts; the number is to look at.
            self.lost
                .store(self.lost.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }

    /// Register `slot` took in message `number` of its wire.
    pub fn saw(&mut self, slot: usize, number: u64, fate: Fate) {
        self.push(SAW + fate_of(fate), slot, number, &[]);
    }

    /// A port took in a message of a tap.
    pub fn tap(&mut self, look: &TapLook<'_>) {
        self.push(TAP + fate_of(look.fate), look.tap.into(), look.number, look.words);
        self.word(look.stamp.0);
    }

    /// A tap of `plug` was joined to port `slot`, known as `tap` from now on.
    pub fn joined(&mut self, slot: usize, tap: u16, how: How, level: u8, plug: u32, time_constant: Span) {
        let number = u64::from(tap) | u64::from(how == How::Inhibit) << 16 | u64::from(level) << 17;
        self.push(JOINED, slot, number, &[]);
        self.word(plug.into());
        self.word(time_constant.0);
    }

    /// The taps of `plug` were told to go.
    pub fn released(&mut self, plug: u32) {
        self.push(RELEASED, 0, plug.into(), &[]);
    }

    /// Outlet `slot` wrote `words` as message `number` of its wire.
    pub fn wrote(&mut self, slot: usize, number: u64, words: &[f64]) {
        self.push(WROTE, slot, number, words);
    }

    /// An inhibitor dropped what outlet `slot` had to say.
    pub fn dropped(&mut self, slot: usize) {
        self.push(DROPPED, slot, 0, &[]);
    }

    /// The halt gate is closed for `causes`.
    pub fn causes(&mut self, causes: u64) {
        self.push(CAUSES, 0, causes, &[]);
    }

    /// The body was told `words` on its input `slot`.
    pub fn passed(&mut self, slot: usize, words: &[f64]) {
        self.push(PASSED, slot, 0, words);
    }

    fn push(&mut self, tag: u64, slot: usize, number: u64, words: &[f64]) {
        let (slot, count) = (slot as u64 & 0xffff, words.len() as u64);
        self.word(tag << 56 | slot << 40 | count << 36 | number & NUMBER_MAX);
        for word in words {
            self.word(word.to_bits());
        }
    }

    /// Past the end it only counts; the beat is then lost.
    fn word(&mut self, word: u64) {
        if let Some(place) = self.beat.get_mut(self.used) {
            *place = word;
        }
        self.used += 1;
    }
}

/// Numbers of messages are kept to 36 bits: two years at 1 kHz.
const NUMBER_MAX: u64 = (1 << 36) - 1;

fn fate_of(fate: Fate) -> u64 {
    match fate {
        Fate::Delivered => 0,
        Fate::Rejected => 1,
        Fate::Fault => 2,
    }
}

impl Trace {
    /// The next beat's words, if one is waiting.
    pub fn next_beat(&mut self) -> Option<Arc<[u64]>> {
        let header = *self.ring.peek().ok()?;
        let length = (header & NUMBER_MAX) as usize;
        assert_eq!(header >> 56, BEAT, "a trace is read beat by beat");
        let chunk = self.ring.read_chunk(length).expect("a beat is handed over whole");
        let (first, second) = chunk.as_slices();
        let words = first.iter().chain(second).copied().collect();
        chunk.commit_all();
        Some(words)
    }

    /// How many beats were lost so far.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beat_goes_round() {
        let (mut tracer, mut trace) = trace(Span::millis(10), 3, 2);
        let words = [1.5, -0.0, f64::NAN];
        let look = TapLook {
            tap: 7,
            number: 9,
            stamp: Time(5),
            words: &words[..2],
            fate: Fate::Rejected,
        };
        for beat in 0..3 {
            tracer.begin(Time(10 + beat));
            tracer.saw(2, 77, Fate::Fault);
            tracer.tap(&look);
            tracer.joined(1, 7, How::Inhibit, 200, 3, Span::secs(2));
            tracer.released(3);
            tracer.wrote(1, NUMBER_MAX, &words[..1]);
            tracer.dropped(0);
            tracer.causes(65);
            tracer.passed(2, &words[1..2]);
            tracer.end(Time(20 + beat));
        }
        for number in 0..3 {
            let beat = decode(&trace.next_beat().expect("three beats were traced"));
            assert_eq!(
                (beat.number, beat.step, beat.commit),
                (number, Time(10 + number), Time(20 + number))
            );
            assert_eq!(beat.entries.len(), 8);
            let first = Entry::Saw {
                slot: 2,
                number: 77,
                fate: Fate::Fault,
            };
            assert_eq!(beat.entries[0], first);
            let Entry::Tap { tap: 7, words, .. } = &beat.entries[1] else {
                panic!("{:?}", beat.entries[1])
            };
            assert_eq!(words, &[1.5, -0.0]);
            let joined = Entry::Joined {
                slot: 1,
                tap: 7,
                how: How::Inhibit,
                level: 200,
                plug: 3,
                time_constant: Span::secs(2),
            };
            assert_eq!(beat.entries[2], joined);
            let wrote = Entry::Wrote {
                slot: 1,
                number: NUMBER_MAX,
                words: vec![1.5],
            };
            assert_eq!(beat.entries[4], wrote);
            assert_eq!(beat.entries[6], Entry::Causes(65));
        }
        assert!(trace.next_beat().is_none());
        assert_eq!(trace.lost(), 0);
    }

    #[test]
    fn beats_that_nobody_fetches_and_beats_too_long_are_counted() {
        let (mut tracer, mut trace) = trace(Span::secs(1), 0, 0);
        let mut ended = 0;
        while trace.lost() == 0 {
            tracer.begin(Time(ended));
            tracer.end(Time(ended));
            ended += 1;
        }
        let fetched = std::iter::from_fn(|| trace.next_beat()).count() as u64;
        assert_eq!(fetched + trace.lost(), ended);
        tracer.begin(Time(0));
        (0..100_000).for_each(|_| tracer.dropped(0));
        tracer.end(Time(0));
        assert_eq!(trace.lost(), 2);
        assert!(trace.next_beat().is_none());
    }
}
