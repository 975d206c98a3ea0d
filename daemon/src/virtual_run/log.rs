//! The log of a run: every message on every wire with its exact stamp, hashed, and kept where asked for.
//!
//! Must never miss a message: whoever writes a wire twice has it scanned in between.

use std::collections::HashMap;

use ipc::clock::Time;
use ipc::message::{Kind, Words};
use ipc::wire::Reader;

/// FNV-1a, 64 bits: start and prime (Fowler, Noll and Vo).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);

/// A message as it was written, or as it was delivered.
pub type Message = (Time, Words);

/// A wire in the log.
#[derive(Debug)]
struct Logged {
    reader: Reader,
    seen: u64,
    kept: Option<Vec<Message>>,
}

/// What was written to the wires of a run.
#[derive(Debug)]
pub struct Log {
    wires: Vec<Logged>,
    numbers: HashMap<String, usize>,
    keep: Vec<String>,
    hash: u64,
    count: u64,
}

impl Log {
    /// An empty log that keeps the messages of the wires in `keep`.
    pub(super) fn new(keep: Vec<String>) -> Log {
        Log {
            wires: Vec::new(),
            numbers: HashMap::new(),
            keep,
            hash: FNV.0,
            count: 0,
        }
    }

    /// Takes up the wire called `name`, or goes on with it after its layer came back. Its number.
    pub(super) fn wire(&mut self, name: String, reader: Reader) -> usize {
        if let Some(&number) = self.numbers.get(&name) {
            self.wires[number].reader = reader;
            self.wires[number].seen = 0;
            return number;
        }
        let kept = self.keep.contains(&name).then(Vec::new);
        self.wires.push(Logged {
            reader,
            seen: 0,
            kept,
        });
        self.numbers.insert(name, self.wires.len() - 1);
        self.wires.len() - 1
    }

    /// Takes in what is new on the wire with this number.
    pub(super) fn scan(&mut self, number: usize) {
        let wire = &mut self.wires[number];
        let Some(reading) = wire.reader.newer_than(wire.seen) else {
            return;
        };
        assert_eq!(
            reading.number,
            wire.seen + 1,
            "a message on wire {number} went unseen"
        );
        wire.seen = reading.number;
        self.count += 1;
        let words = &reading.words[..wire.reader.kind().words()];
        let mut hash = self.hash;
        let bits = words.iter().map(|w| w.to_bits());
        for bits in [number as u64, reading.stamp.0].into_iter().chain(bits) {
            for byte in bits.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(FNV.1);
            }
        }
        self.hash = hash;
        if let Some(kept) = &mut wire.kept {
            kept.push((reading.stamp, reading.words));
        }
    }

    /// The hash of every message so far: number of its wire, stamp and the bits of its words, FNV-1a.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// How many messages were written so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The messages written to the wire called `name` so far, if they are kept.
    pub fn messages(&self, name: &str) -> &[Message] {
        let wire = self.numbers.get(name).map(|&n| &self.wires[n]);
        wire.and_then(|w| w.kept.as_deref()).unwrap_or_default()
    }

    /// The kind of message on the wire called `name`, if it was there at any time.
    pub fn kind(&self, name: &str) -> Option<Kind> {
        Some(self.wires[*self.numbers.get(name)?].reader.kind())
    }
}
