//! The ring: the newest stretch of what happened, bounded in time and in memory.
//!
//! Must never grow without bound, nor forget silently: what falls out at the old end is folded into a [`Base`] for
//! each source, so that a recording made from the ring still says what every register held when it begins.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use afsm::trace::{self, Entry};
use ipc::clock::{Span, Time};
use ipc::wire::Fate;

use crate::item::{Base, Held, Item};
use crate::manifest::{Manifest, Plugged};

/// Most memory a ring takes, whatever its span: a minute of a hundred wires at 300 Hz, and little beside what a
/// creature's own memory comes to on a robot with 1 GiB.
pub const RING_BYTES_MAX: usize = 64 << 20;

/// The newest items.
#[derive(Clone, Debug)]
pub struct Ring {
    span: Span,
    bytes_max: usize,
    /// Each with the moment at which it was taken in.
    items: VecDeque<(Time, Item)>,
    /// The newest moment that the daemon itself has told. What an attached layer stamps may lie anywhere: a message
    /// from the future would otherwise hold up everything behind it.
    now: Time,
    bytes: usize,
    past: Past,
}

/// What has fallen out of a ring, folded into what it left behind.
#[derive(Clone, Debug)]
struct Past {
    sources: Vec<SourceBase>,
    plugs: BTreeMap<u32, (Time, Arc<Plugged>)>,
    /// The newest message of each wire of an attached layer: nobody else remembers it.
    wires: BTreeMap<(u32, usize), Item>,
}

/// What a source held when its oldest beat in the ring began.
#[derive(Clone, Debug)]
struct SourceBase {
    base: Base,
    /// Of each register, the source and outlet whose wire it takes.
    feeds: Vec<Option<(usize, usize)>>,
    taps: BTreeMap<u16, (Held, Fate)>,
    /// Whose each tap is that was joined while the source beat.
    joined: BTreeMap<u16, u32>,
    begun: bool,
}

impl SourceBase {
    /// Lets go of what the taps of a layer said that has left.
    fn forget(&mut self, plug: u32) {
        let joined = &self.joined;
        self.taps.retain(|tap, _| joined.get(tap) != Some(&plug));
        self.joined.retain(|_, whose| *whose != plug);
    }
}

impl Ring {
    /// An empty ring for a creature: holds what happened within `span`, in at most `bytes_max` bytes.
    pub fn new(manifest: &Manifest, span: Span, bytes_max: usize) -> Ring {
        let sources = manifest
            .sources
            .iter()
            .enumerate()
            .map(|(index, source)| SourceBase {
                base: Base {
                    source: index as u16,
                    wrote: vec![None; source.outputs.len()],
                    saw: vec![None; source.inputs.len()],
                    passed: vec![None; source.inputs.len()],
                    ..Base::default()
                },
                feeds: source
                    .inputs
                    .iter()
                    .map(|port| manifest.writer_of(manifest.wire_into(&port.name)?))
                    .collect(),
                taps: BTreeMap::new(),
                joined: BTreeMap::new(),
                begun: false,
            });
        let plugs = manifest.plugs.iter();
        let past = Past {
            sources: sources.collect(),
            plugs: plugs
                .map(|p| (p.number, (Time(manifest.began_ns), Arc::new(p.clone()))))
                .collect(),
            wires: BTreeMap::new(),
        };
        Ring {
            span,
            bytes_max,
            items: VecDeque::new(),
            now: Time::ZERO,
            bytes: 0,
            past,
        }
    }

    /// Takes in an item, and lets go of what is too old.
    pub fn push(&mut self, item: Item) {
        if !matches!(item, Item::Wire { .. }) {
            self.now = self.now.max(item.time());
        }
        self.bytes += item.bytes();
        self.items.push_back((self.now, item));
        while let Some((taken_in, oldest)) = self.items.front() {
            let old = self.now.since(*taken_in) > self.span;
            if !old && self.bytes <= self.bytes_max {
                break;
            }
            self.bytes -= oldest.bytes();
            if let Some((_, item)) = self.items.pop_front() {
                self.past.fold(&item);
            }
        }
    }

    /// Everything in it, after what was before.
    pub fn snapshot(&self) -> Vec<Item> {
        let items = self.items.iter().map(|(_, item)| item.clone());
        self.past.items().chain(items).collect()
    }

    /// What every source holds now: how a recording begins that has no use for the past.
    pub fn state(&self) -> Vec<Item> {
        let mut past = self.past.clone();
        self.items.iter().for_each(|(_, item)| past.fold(item));
        past.items().collect()
    }

    /// How long ago its oldest item happened, counted from its newest.
    pub fn covers(&self) -> Span {
        match (self.items.front(), self.items.back()) {
            (Some((first, _)), Some((last, _))) => last.since(*first),
            _ => Span::ZERO,
        }
    }
}

impl Past {
    fn items(&self) -> impl Iterator<Item = Item> {
        let begun = self.sources.iter().filter(|s| s.begun);
        let bases = begun.map(|s| {
            let taps = s.taps.iter();
            Item::Base(Arc::new(Base {
                taps: taps
                    .map(|(tap, (held, fate))| (*tap, held.clone(), *fate))
                    .collect(),
                ..s.base.clone()
            }))
        });
        let plugs = self.plugs.values();
        plugs
            .map(|(time, plug)| Item::Plugged(*time, plug.clone()))
            .chain(self.wires.values().cloned())
            .chain(bases)
    }

    fn fold(&mut self, item: &Item) {
        match item {
            Item::Beat { source, words } => self.fold_beat(*source as usize, words),
            Item::Plugged(time, plugged) => {
                self.plugs.insert(plugged.number, (*time, plugged.clone()));
            }
            Item::Unplugged(_, number) => {
                self.plugs.remove(number);
                self.wires.retain(|(plug, _), _| plug != number);
                for source in &mut self.sources {
                    source.forget(*number);
                }
            }
            Item::Wire { plug, index, .. } => {
                self.wires.insert((*plug, *index), item.clone());
            }
            _ => {}
        }
    }

    fn fold_beat(&mut self, source: usize, words: &[u64]) {
        let beat = trace::decode(words);
        self.sources[source].begun = true;
        self.sources[source].base.beat = (beat.number, beat.step, beat.commit);
        for entry in beat.entries {
            let held = |number, stamp, words| Held {
                number,
                stamp,
                words: Some(words),
            };
            match entry {
                Entry::Saw { slot, number, fate } => {
                    let message = self.message(source, slot, number);
                    self.sources[source].base.saw[slot] = Some((message, fate));
                }
                Entry::Tap {
                    tap,
                    number,
                    stamp,
                    words,
                    fate,
                } => {
                    let taps = &mut self.sources[source].taps;
                    taps.insert(tap, (held(number, stamp, words), fate));
                }
                Entry::Wrote { slot, number, words } => {
                    self.sources[source].base.wrote[slot] = Some(held(number, beat.commit, words));
                }
                Entry::Causes(causes) => self.sources[source].base.causes = causes,
                Entry::Passed { slot, words } => {
                    self.sources[source].base.passed[slot] = Some(held(0, beat.commit, words));
                }
                Entry::Joined { tap, plug, .. } => {
                    self.sources[source].joined.insert(tap, plug);
                }
                Entry::Released { .. } | Entry::Dropped { .. } => {}
            }
        }
    }

    /// Message `number` of the wire into a register, as far as it is still known.
    fn message(&self, source: usize, slot: usize, number: u64) -> Held {
        let feed = self.sources[source].feeds[slot];
        let wrote = feed.and_then(|(source, slot)| self.sources[source].base.wrote[slot].clone());
        wrote.filter(|held| held.number == number).unwrap_or(Held {
            number,
            stamp: Time::ZERO,
            words: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use ipc::message::{Kind, WORDS_MAX};
    use ipc::wire::Reading;

    use super::*;
    use crate::manifest::FORMAT;

    fn nobody() -> Manifest {
        Manifest {
            format: FORMAT,
            creature: "none".into(),
            program: "test".into(),
            seed: 0,
            began_ns: 0,
            offset_ns: 0,
            causes: Vec::new(),
            sources: Vec::new(),
            taps: Vec::new(),
            wires: Vec::new(),
            plugs: Vec::new(),
            file: String::new(),
        }
    }

    #[test]
    fn a_message_from_the_future_holds_nothing_up() {
        let mut ring = Ring::new(&nobody(), Span::secs(1), usize::MAX);
        let second = |n: u64| Time(n * 1_000_000_000);
        let gone = |n: u64| Item::Unplugged(second(n), 7);
        ring.push(gone(0));
        ring.push(Item::Wire {
            plug: 7,
            index: 0,
            kind: Kind::Number,
            reading: Box::new(Reading {
                number: 1,
                stamp: second(1_000_000),
                words: [0.0; WORDS_MAX],
            }),
        });
        (1..100).for_each(|n| ring.push(gone(n)));
        assert_eq!(ring.items.len(), 2, "what is older than a second is gone");
        assert_eq!(ring.covers(), Span::secs(1));
    }
}
