//! The recorder's end of a trace: fetches beats, and writes them out in full.
//!
//! Must never run on a real-time thread, it allocates; nor lose or add anything to what was traced.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rtrb::Consumer;

use super::{
    BEAT, HEADER, JOINED, LAST_SEEN, LAST_WROTE, LENGTH_MAX, NUMBER_MAX, SAW, SLOTS_MAX, TAP, WROTE, head,
};

/// The recorder's end of a trace.
#[derive(Debug)]
pub struct Trace {
    ring: Consumer<u64>,
    lost: Arc<AtomicU64>,
    /// The last number of each register.
    saw: Box<[u64]>,
    /// The last number of each outlet, and how many words its messages have.
    wrote: Box<[(u64, usize)]>,
    /// The beat as it came.
    short: Vec<u64>,
    /// The beat in full.
    full: Vec<u64>,
}

impl Trace {
    /// The other end of `ring`, for so many registers and outlets.
    pub(super) fn new(
        ring: Consumer<u64>,
        (registers, outlets): (usize, usize),
        lost: Arc<AtomicU64>,
    ) -> Trace {
        Trace {
            ring,
            lost,
            saw: vec![0; registers].into(),
            wrote: vec![(0, 0); outlets].into(),
            short: Vec::new(),
            full: Vec::new(),
        }
    }

    /// The next beat's words, if one is waiting.
    pub fn next_beat(&mut self) -> Option<Arc<[u64]>> {
        let header = *self.ring.peek().ok()?;
        assert_eq!(header >> 56, BEAT, "a trace is read beat by beat");
        let length = (header & LENGTH_MAX) as usize;
        let chunk = self.ring.read_chunk(length).expect("a beat is handed over whole");
        let (first, second) = chunk.as_slices();
        self.short.clear();
        self.short.extend_from_slice(first);
        self.short.extend_from_slice(second);
        chunk.commit_all();
        self.write_out();
        Some(self.full.as_slice().into())
    }

    /// How many beats were lost so far.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// Words that wait to be fetched.
    #[cfg(test)]
    pub(super) fn waiting(&self) -> usize {
        self.ring.slots()
    }

    /// Writes the beat out in full: registers that took in the next message, what else happened, outlets that wrote
    /// the next message.
    fn write_out(&mut self) {
        let (short, entries) = self
            .short
            .split_at(self.short.len() - (self.short[0] >> 28 & LENGTH_MAX) as usize);
        let (times, short) = short.split_at(HEADER);
        let (saw, short) = short.split_at(self.saw.len().div_ceil(SLOTS_MAX));
        let (wrote, mut words) = short.split_at(self.wrote.len().div_ceil(SLOTS_MAX));
        for slot in slots(saw) {
            self.saw[slot] = self.saw[slot].wrapping_add(1) & NUMBER_MAX;
        }
        for slot in slots(wrote) {
            self.wrote[slot].0 = self.wrote[slot].0.wrapping_add(1) & NUMBER_MAX;
        }
        let told = count_on(entries, &mut self.saw, &mut self.wrote);
        self.full.clear();
        self.full.extend_from_slice(times);
        let saw = slots(saw).map(|slot| head(SAW, slot, 0, self.saw[slot]));
        self.full.extend(saw);
        self.full.extend_from_slice(&entries[..told]);
        for slot in slots(wrote) {
            let (number, count) = self.wrote[slot];
            let (own, rest) = words.split_at(count);
            self.full.push(head(WROTE, slot, count, number));
            self.full.extend_from_slice(own);
            words = rest;
        }
        assert!(words.is_empty(), "every word belongs to an outlet");
        self.full[0] = BEAT << 56 | self.full.len() as u64;
    }
}

/// Takes over the numbers that entries tell. The last numbers come last; gives where they begin.
fn count_on(entries: &[u64], saw: &mut [u64], wrote: &mut [(u64, usize)]) -> usize {
    let mut place = 0;
    let mut told = None;
    while let Some(&head) = entries.get(place) {
        let (tag, slot) = (head >> 56, (head >> 40 & 0xffff) as usize);
        let (count, number) = ((head >> 36 & 0xf) as usize, head & NUMBER_MAX);
        match tag {
            SAW..TAP | LAST_SEEN => set(saw, slot, number),
            WROTE | LAST_WROTE => set(wrote, slot, (number, count)),
            _ => {}
        }
        if matches!(tag, LAST_SEEN | LAST_WROTE) {
            told.get_or_insert(place);
            place += 1;
            continue;
        }
        let after = match tag {
            TAP..JOINED => 1,
            JOINED => 2,
            _ => 0,
        };
        place += 1 + count + after;
    }
    told.unwrap_or(entries.len())
}

fn set<T>(known: &mut [T], slot: usize, last: T) {
    if let Some(place) = known.get_mut(slot) {
        *place = last;
    }
}

/// The slots whose bit is set, in order.
fn slots(bits: &[u64]) -> impl Iterator<Item = usize> {
    bits.iter().enumerate().flat_map(|(index, &word)| {
        std::iter::successors(Some(word), |left| Some(left & left.wrapping_sub(1)))
            .take_while(|&left| left != 0)
            .map(move |left| index * SLOTS_MAX + left.trailing_zeros() as usize)
    })
}
