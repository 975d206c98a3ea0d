//! Entries: a traced beat taken apart again, for those who record it.
//!
//! Must never run on a real-time thread; it allocates.

use ipc::clock::{Span, Time};
use ipc::wire::Fate;
use ipc::wiring::creature::How;

use super::{CAUSES, DROPPED, HEADER, JOINED, NUMBER_MAX, PASSED, RELEASED, SAW, TAP, WROTE};

/// Something that happened in a beat.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A register took in a message of its wire.
    Saw {
        /// The register.
        slot: usize,
        /// The message.
        number: u64,
        /// What became of it.
        fate: Fate,
    },
    /// A port took in a message of a tap.
    Tap {
        /// The tap.
        tap: u16,
        /// The message.
        number: u64,
        /// When it was written.
        stamp: Time,
        /// What it says.
        words: Vec<f64>,
        /// What became of it.
        fate: Fate,
    },
    /// A tap was joined.
    Joined {
        /// The register or outlet.
        slot: usize,
        /// The tap.
        tap: u16,
        /// Which way it acts.
        how: How,
        /// The level it comes from.
        level: u8,
        /// The layer it belongs to.
        plug: u32,
        /// Its time constant.
        time_constant: Span,
    },
    /// The taps of a layer were told to go.
    Released {
        /// The layer.
        plug: u32,
    },
    /// An outlet wrote a message.
    Wrote {
        /// The outlet.
        slot: usize,
        /// The message's number on its wire.
        number: u64,
        /// What it says.
        words: Vec<f64>,
    },
    /// An inhibitor dropped a message.
    Dropped {
        /// The outlet.
        slot: usize,
    },
    /// The halt gate is closed for these causes; 0 if it is open.
    Causes(u64),
    /// The body was told something.
    Passed {
        /// The body's input.
        slot: usize,
        /// What it was told.
        words: Vec<f64>,
    },
}

/// A beat as it was traced.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedBeat {
    /// How many came before it.
    pub number: u64,
    /// What the modules were told the time is.
    pub step: Time,
    /// When its messages were written.
    pub commit: Time,
    /// What happened in it, in order.
    pub entries: Vec<Entry>,
}

/// Number, step and commit of a beat's words.
pub fn times(words: &[u64]) -> (u64, Time, Time) {
    (words[1], Time(words[2]), Time(words[3]))
}

/// Reads the words of one beat.
///
/// # Panics
/// When they are not what [`Trace::next_beat`](super::Trace::next_beat) gave.
pub fn decode(words: &[u64]) -> TracedBeat {
    let (number, step, commit) = times(words);
    let mut entries = Vec::new();
    let mut rest = words[HEADER..].iter().copied();
    while let Some(head) = rest.next() {
        entries.push(entry(head, &mut rest));
    }
    TracedBeat {
        number,
        step,
        commit,
        entries,
    }
}

fn entry(head: u64, rest: &mut impl Iterator<Item = u64>) -> Entry {
    let (tag, slot) = (head >> 56, (head >> 40 & 0xffff) as usize);
    let (count, number) = ((head >> 36 & 0xf) as usize, head & NUMBER_MAX);
    let words: Vec<f64> = rest.by_ref().take(count).map(f64::from_bits).collect();
    let mut word = || rest.next().expect("an entry is whole");
    match tag {
        SAW..TAP => Entry::Saw {
            slot,
            number,
            fate: fate(tag - SAW),
        },
        TAP..JOINED => Entry::Tap {
            tap: slot as u16,
            number,
            stamp: Time(word()),
            words,
            fate: fate(tag - TAP),
        },
        JOINED => Entry::Joined {
            slot,
            tap: number as u16,
            how: if number >> 16 & 1 == 1 {
                How::Inhibit
            } else {
                How::Suppress
            },
            level: (number >> 17) as u8,
            plug: word() as u32,
            time_constant: Span(word()),
        },
        RELEASED => Entry::Released { plug: number as u32 },
        WROTE => Entry::Wrote { slot, number, words },
        DROPPED => Entry::Dropped { slot },
        CAUSES => Entry::Causes(number),
        PASSED => Entry::Passed { slot, words },
        other => panic!("there is no entry {other} in a trace"),
    }
}

fn fate(offset: u64) -> Fate {
    match offset {
        0 => Fate::Delivered,
        1 => Fate::Rejected,
        _ => Fate::Fault,
    }
}
