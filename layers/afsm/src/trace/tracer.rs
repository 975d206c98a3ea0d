//! The beating thread's end of a trace: puts a beat together and hands it over whole.
//!
//! Must never wait, allocate or call anything; nor let the other side count on from a number it does not know.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::wire::{Fate, TapLook};
use ipc::wiring::creature::How;
use rtrb::Producer;

use super::{
    BEAT, CAUSES, DROPPED, HEADER, JOINED, LAST_SEEN, LAST_WROTE, PASSED, RELEASED, SAW, SLOTS_MAX, TAP,
    WROTE, head,
};

/// The beating thread's end of a trace.
#[derive(Debug)]
pub struct Tracer {
    ring: Producer<u64>,
    /// Header, bits and words of messages.
    beat: Box<[u64]>,
    used: usize,
    /// A byte for each register, then for each outlet, in whole words of bits: 1 if it took in or wrote its next
    /// message. A byte is set faster than a bit.
    next: Box<[u8]>,
    /// Where the outlets' bytes begin.
    registers: usize,
    /// Everything that takes an entry.
    entries: Box<[u64]>,
    told: usize,
    /// The other side does not know the last numbers.
    anew: bool,
    beats: u64,
    lost: Arc<AtomicU64>,
}

impl Tracer {
    /// A tracer into `ring` of so many registers and outlets, with room for a beat of `words`.
    pub(super) fn new(
        ring: Producer<u64>,
        (registers, outlets): (usize, usize),
        words: usize,
        lost: Arc<AtomicU64>,
    ) -> Tracer {
        let registers = registers.next_multiple_of(SLOTS_MAX);
        let slots = registers + outlets.next_multiple_of(SLOTS_MAX);
        Tracer {
            ring,
            // Touched, both of them: no beat is to be the first.
            beat: vec![1; words].into(),
            used: 0,
            next: vec![1; slots].into(),
            registers,
            entries: vec![1; words].into(),
            told: 0,
            anew: true,
            beats: 0,
            lost,
        }
    }

    /// A beat begins: its modules are told that it is `now`.
    pub fn begin(&mut self, now: Time) {
        self.used = HEADER + self.next.len() / SLOTS_MAX;
        self.told = 0;
        self.beat[1] = self.beats;
        self.beat[2] = now.0;
        self.next.fill(0);
        self.beats += 1;
    }

    /// The beat ends: what it wrote was stamped `now`.
    pub fn end(&mut self, now: Time) {
        if !self.hand_over(now) {
            // Only this thread counts; the number is to look at.
            self.lost
                .store(self.lost.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
            self.forget();
        }
    }

    fn hand_over(&mut self, now: Time) -> bool {
        let length = self.used + self.told;
        if length > self.beat.len() {
            return false;
        }
        self.beat[0] = BEAT << 56 | (self.told as u64) << 28 | length as u64;
        self.beat[3] = now.0;
        for (word, next) in self.beat[HEADER..]
            .iter_mut()
            .zip(self.next.chunks_exact(SLOTS_MAX))
        {
            *word = bits(next);
        }
        if self.told > 0 {
            self.beat[self.used..length].copy_from_slice(&self.entries[..self.told]);
        }
        self.ring.push_entire_slice(&self.beat[..length]).is_ok()
    }

    /// The other side no longer knows the last numbers: messages went by that were not traced.
    pub fn forget(&mut self) {
        self.anew = true;
    }

    /// Whether this beat has to [tell the numbers](Tracer::tell_numbers) before it ends.
    pub fn begins_anew(&self) -> bool {
        self.anew
    }

    /// Tells the last number of every register, and of every outlet with its kind, as they are after this beat.
    pub fn tell_numbers(
        &mut self,
        registers: impl Iterator<Item = u64>,
        outlets: impl Iterator<Item = (u64, Kind)>,
    ) {
        self.anew = false;
        for (slot, number) in registers.enumerate() {
            self.push(LAST_SEEN, slot, number, &[]);
        }
        for (slot, (number, kind)) in outlets.enumerate() {
            self.word(head(LAST_WROTE, slot, kind.words(), number));
        }
    }

    /// Register `slot` took in message `number` of its wire.
    pub fn saw(&mut self, slot: usize, number: u64, fate: Fate) {
        self.push(SAW + fate_of(fate), slot, number, &[]);
    }

    /// Register `slot` took in the message of its wire that comes after the last that it took in, and it was
    /// delivered; its only one in this beat.
    #[inline]
    pub fn saw_next(&mut self, slot: usize) {
        if let Some(next) = self.next.get_mut(slot) {
            *next = 1;
        }
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

    /// Outlet `slot` wrote `words` as the message after its last, its only one in this beat. Outlets come in order.
    #[inline]
    pub fn wrote_next(&mut self, slot: usize, kind: Kind, words: &[f64]) {
        if let Some(next) = self.next.get_mut(self.registers + slot) {
            *next = 1;
        }
        if kind.single() {
            return self.follow(words[0]);
        }
        self.follow_all(kind, words);
    }

    #[inline(never)]
    fn follow_all(&mut self, kind: Kind, words: &[f64]) {
        words[..kind.words()].iter().for_each(|word| self.follow(*word));
    }

    /// A word of a message. Past the end it only counts; the beat is then lost.
    #[inline]
    fn follow(&mut self, word: f64) {
        if let Some(place) = self.beat.get_mut(self.used) {
            *place = word.to_bits();
        }
        self.used += 1;
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
        self.word(head(tag, slot, words.len(), number));
        for word in words {
            self.word(word.to_bits());
        }
    }

    /// Past the end it only counts; the beat is then lost.
    fn word(&mut self, word: u64) {
        if let Some(place) = self.entries.get_mut(self.told) {
            *place = word;
        }
        self.told += 1;
    }
}

/// The bits of 64 bytes that are 0 or 1.
#[inline]
fn bits(bytes: &[u8]) -> u64 {
    let eights = bytes.chunks_exact(8).enumerate();
    eights.fold(0, |bits, (k, eight)| {
        let eight = u64::from_le_bytes(eight.try_into().expect("eight"));
        // Each byte's bit moves to its place in the topmost byte, and no two meet on the way.
        bits | (eight.wrapping_mul(0x0102_0408_1020_4080) >> 56) << (8 * k)
    })
}

fn fate_of(fate: Fate) -> u64 {
    match fate {
        Fate::Delivered => 0,
        Fate::Rejected => 1,
        Fate::Fault => 2,
    }
}
