//! Beats: what a traced beat says, spread over the channels of a recording.
//!
//! Must never count a message from before the recording: it is marked instead.

use std::io::Write;

use afsm::trace::{self, Entry};
use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wire::Fate;
use ipc::wiring::creature::How;
use mcap::McapResult;
use serde_json::json;

use super::Writer;
use super::channel::PlugChannels;
use crate::item::{Base, Held};
use crate::text::{BeatNote, message_text};

impl<W: Write> Writer<W> {
    pub(super) fn beat(&mut self, source: usize, words: &[u64]) -> McapResult<()> {
        let beat = trace::decode(words);
        self.newest = self.newest.max(beat.commit);
        let mut note = BeatNote::default();
        for entry in beat.entries {
            match entry {
                Entry::Saw { slot, number, fate } => note.saw(slot, number, fate),
                Entry::Tap {
                    tap,
                    number,
                    stamp,
                    words,
                    fate,
                } => {
                    note.taps.push((tap, number, stamp.0, fate as u8));
                    if fate == Fate::Delivered {
                        self.tap(beat.commit, tap, number, stamp)?;
                    }
                    if let (Some((plug, index)), true) = (self.foreign_wire(tap), fate != Fate::Fault) {
                        self.foreign(plug, index, number, stamp, &words)?;
                    }
                }
                Entry::Joined {
                    slot,
                    tap,
                    how,
                    level,
                    plug,
                    time_constant,
                } => note.joined.push(json!({
                    "slot": slot, "tap": tap, "how": how, "level": level, "plug": plug,
                    "time_constant_ns": time_constant.0,
                })),
                Entry::Released { plug } => note.released.push(plug),
                Entry::Wrote { slot, number, words } => {
                    let wire = &mut self.sources[source].outputs[slot];
                    wire.count(number);
                    let (id, kind) = (wire.id, wire.kind);
                    self.message(id, kind, number, beat.commit, &words)?;
                }
                Entry::Dropped { slot } => note.dropped.push(slot),
                Entry::Causes(causes) => {
                    note.causes = Some(causes);
                    self.causes(beat.commit, causes)?;
                }
                Entry::Passed { slot, words } => {
                    let (id, kind) = self.sources[source].commands[slot];
                    self.message(id, kind, beat.number, beat.commit, &words)?;
                }
            }
        }
        let text = note.text((beat.number, beat.step, beat.commit), false);
        self.text.clear();
        self.text.extend(text.to_string().as_bytes());
        self.send(self.sources[source].beats, beat.number, beat.commit)
    }

    /// Writes what a source held: the messages themselves, then a beat that is marked as none.
    pub(super) fn base(&mut self, base: &Base) -> McapResult<()> {
        let source = usize::from(base.source);
        let mut note = BeatNote::default();
        for (slot, wrote) in base.wrote.iter().enumerate() {
            if let Some(held) = wrote {
                let wire = &self.sources[source].outputs[slot];
                self.before(wire.id, wire.kind, held)?;
            }
        }
        for (slot, saw) in base.saw.iter().enumerate() {
            let Some((held, fate)) = saw else { continue };
            note.saw(slot, held.number, *fate);
            let port = &self.manifest.sources[source].inputs[slot];
            let feed = self
                .manifest
                .wire_into(&port.name)
                .and_then(|wire| self.manifest.writer_of(wire));
            if let Some((source, slot)) = feed {
                // Comes twice where it is the wire's newest as well; readers take it once.
                let wire = &self.sources[source].outputs[slot];
                self.before(wire.id, wire.kind, held)?;
            }
        }
        for (tap, held, fate) in &base.taps {
            note.taps.push((*tap, held.number, held.stamp.0, *fate as u8));
            if let Some((plug, index)) = self.foreign_wire(*tap) {
                let wire = &self.plugs[&plug].outputs[index];
                self.before(wire.id, wire.kind, held)?;
            }
        }
        for (slot, passed) in base.passed.iter().enumerate() {
            if let Some(Held {
                stamp,
                words: Some(words),
                ..
            }) = passed
            {
                let (id, kind) = self.sources[source].commands[slot];
                self.message(id, kind, base.beat.0, *stamp, words)?;
            }
        }
        if !self.sources[source].commands.is_empty() {
            note.causes = Some(base.causes);
            self.causes(base.beat.2, base.causes)?;
        }
        let text = note.text(base.beat, true);
        self.text.clear();
        self.text.extend(text.to_string().as_bytes());
        self.send(self.sources[source].beats, base.beat.0, base.beat.2)
    }

    /// A message from before the recording begins: marked, and not counted.
    fn before(&mut self, id: u16, kind: Kind, held: &Held) -> McapResult<()> {
        let Some(words) = &held.words else { return Ok(()) };
        message_text(&mut self.text, kind, held.number, held.stamp, words);
        self.text.pop();
        self.text.extend(b",\"before\":true}");
        self.send(id, held.number, held.stamp)
    }

    /// The layer and output that a tap's messages come from, if that layer is a process of its own: its wires may
    /// not be recorded otherwise, or not yet.
    fn foreign_wire(&self, tap: u16) -> Option<(u32, usize)> {
        let tap = self.taps.get(&tap)?;
        let of_wire = |(plug, channels): (&u32, &PlugChannels)| {
            let index = channels.outputs.iter().position(|o| o.name == tap.from)?;
            (channels.layer == tap.layer).then_some((*plug, index))
        };
        // The newest layer of that name.
        self.plugs.iter().rev().find_map(of_wire)
    }

    fn tap(&mut self, time: Time, tap: u16, number: u64, stamp: Time) -> McapResult<()> {
        let Some(t) = self.taps.get(&tap) else {
            return Ok(());
        };
        let kind = if t.how == How::Suppress {
            "suppress"
        } else {
            "inhibit"
        };
        let until = stamp + t.time_constant;
        let text = json!({
            "tap": tap, "kind": kind, "layer": t.layer, "from": t.from, "to": t.to, "number": number,
            "stamp_ns": stamp.0, "until_ns": until.0,
        });
        self.rest("/taps", time, &text)
    }

    fn causes(&mut self, time: Time, causes: u64) -> McapResult<()> {
        if self.causes.replace(causes) == Some(causes) {
            return Ok(());
        }
        let text = json!({"halted": causes != 0, "causes": self.manifest.cause_names(causes)});
        self.rest("/halts", time, &text)
    }
}
