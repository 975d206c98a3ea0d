//! Why: the chain behind a message, back to the sensors; and who holds each tapped port.
//!
//! Must never claim more than was recorded: what a layer of the daemon looked at is known to the message; what a
//! layer process looked at is told from stamps, and marked so.
//!
//! ```text
//!   message ─► the beat that wrote it ─► its module's registers ─► what each held, who had brought it ─► …
//! ```
//! Wires may run in a ring (a module may listen to what follows from it): a message that was explained once is not
//! explained again, so every chain ends.

mod holders;
mod link;

use std::collections::HashSet;

use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::tap::Window;
use ipc::wire::Fate;
use ipc::wiring::creature::How;

pub use holders::{Holder, holders};
pub use link::{Input, Link, Rejected, TapSeen};

use crate::manifest::{MOTOR, Tap};
use crate::reader::{Message, Recording, TapMessage};

/// Longest chain that is followed: each step is one message of one module, and the deepest of the source's stacks
/// has fourteen layers of a few modules each.
const STEPS_MAX: usize = 64;

/// The chain behind the newest message of `wire` at the moment `at`; `wire` may be an input port as well.
///
/// # Errors
/// A sentence, when there is no such wire or nothing was on it.
pub fn why(recording: &Recording, wire: &str, at: Time) -> Result<Link, String> {
    let mut chain = Chain {
        recording,
        explained: HashSet::new(),
    };
    let names = names(recording);
    if !names.iter().any(|n| n == wire) && recording.manifest.register_of(wire).is_some() {
        return chain
            .port(wire, at)
            .ok_or_else(|| format!("{wire} has had no message, and is not tapped"));
    }
    if !names.iter().any(|n| n == wire) {
        let help = ipc::wiring::diagnostic::one_of("wire", wire, names.iter().map(String::as_str));
        return Err(format!("there is no wire {wire:?}; {help}"));
    }
    let nothing = || {
        let seconds = recording.manifest.seconds(at);
        format!("nothing was recorded on {wire} up to {seconds:.3} s")
    };
    if let Some(told) = recording.commands.get(wire) {
        let told = before(told, at).ok_or_else(nothing)?;
        return Ok(chain.command(wire, told, at));
    }
    let (plug, message) = newest(recording, wire, at).ok_or_else(nothing)?;
    Ok(chain.link(plug, wire, &message, at, 0))
}

/// Every wire, and every input of the body.
pub fn names(recording: &Recording) -> Vec<String> {
    let manifest = &recording.manifest;
    let outputs = manifest
        .sources
        .iter()
        .flat_map(|s| s.outputs.iter().map(|o| o.name.clone()));
    let plugged = recording
        .plugs
        .iter()
        .flat_map(|(_, p)| p.plug.outputs.iter().map(|o| o.name.clone()));
    let motor = manifest.sources.iter().filter(|s| s.name == MOTOR);
    let inputs = motor.flat_map(|s| s.inputs.iter().map(|i| i.name.clone()));
    let mut names: Vec<String> = outputs.chain(plugged).chain(inputs).collect();
    names.sort();
    names.dedup();
    names
}

fn before(messages: &[Message], at: Time) -> Option<&Message> {
    let end = messages.partition_point(|m| m.stamp <= at);
    messages[..end].last()
}

/// The newest message of a wire, the creature's or an attached layer's.
fn newest(recording: &Recording, wire: &str, at: Time) -> Option<(u32, Message)> {
    let wires = recording.wires.iter().filter(|((_, name), _)| name == wire);
    let found = wires.filter_map(|((plug, _), messages)| Some((*plug, *before(messages, at)?)));
    found.max_by_key(|(_, m)| m.stamp)
}

struct Chain<'r> {
    recording: &'r Recording,
    explained: HashSet<(u32, String, u64)>,
}

impl Chain<'_> {
    /// What the body was told.
    fn command(&mut self, port: &str, told: &Message, at: Time) -> Link {
        let manifest = &self.recording.manifest;
        let source = self.recording.motor().unwrap_or(0);
        let slot = manifest.sources[source]
            .inputs
            .iter()
            .position(|i| i.name == port);
        let mut link = self.bare(port, told, at, slot.map(|s| &manifest.sources[source].inputs[s]));
        link.layer = MOTOR.into();
        if let Some((index, traced)) = self.beat_at(source, told.stamp) {
            link.traced = traced;
            let causes = self.recording.beats[source][index].causes.unwrap_or(0);
            link.halted = manifest.cause_names(causes).into_iter().map(Into::into).collect();
            link.inputs = slot
                .into_iter()
                .filter_map(|s| self.input(source, s, index, 0))
                .collect();
        }
        link
    }

    /// What an input port holds.
    fn port(&mut self, port: &str, at: Time) -> Option<Link> {
        let (source, slot) = self.recording.manifest.register_of(port)?;
        let (index, _) = self.beat_at(source, at)?;
        let input = self.input(source, slot, index, 0)?;
        let held = input.held.as_deref()?;
        let of = &self.recording.manifest.sources[source];
        Some(Link {
            wire: port.into(),
            module: port.split_once('.').map(|(module, _)| module.to_string()),
            layer: of.name.clone(),
            level: of.level,
            pid: None,
            halted: Vec::new(),
            traced: true,
            inhibited: 0,
            above: false,
            inputs: vec![input.clone()],
            ..held.clone()
        })
    }

    fn bare(&self, wire: &str, message: &Message, at: Time, slot: Option<&crate::manifest::Slot>) -> Link {
        let kind = slot.map_or(Kind::Map, |s| s.kind);
        Link {
            wire: wire.into(),
            number: message.number,
            time_s: self.recording.manifest.seconds(message.stamp),
            age_ms: at.since(message.stamp).as_millis_f64(),
            value: message.words[..kind.words()].to_vec(),
            unit: slot.map_or(String::new(), |s| s.unit.clone()),
            module: None,
            layer: String::new(),
            level: None,
            pid: None,
            halted: Vec::new(),
            traced: true,
            inhibited: 0,
            above: false,
            inputs: Vec::new(),
        }
    }

    /// A message on a wire, looked at `at`.
    fn link(&mut self, plug: u32, wire: &str, message: &Message, at: Time, depth: usize) -> Link {
        let new = self.explained.insert((plug, wire.to_string(), message.number));
        let mut link = if plug == 0 {
            let (source, slot) = self.recording.manifest.writer_of(wire).unwrap_or((0, 0));
            let written = &self.recording.manifest.sources[source];
            let mut link = self.bare(wire, message, at, written.outputs.get(slot));
            (link.layer, link.level) = (written.name.clone(), written.level);
            if written.name != MOTOR {
                link.module = wire.split_once('.').map(|(module, _)| module.to_string());
            }
            let beats = self.recording.beats[source].iter();
            let since = beats.filter(|b| b.commit_ns > message.stamp.0 && b.commit_ns <= at.0);
            link.inhibited = since.filter(|b| b.dropped.contains(&slot)).count() as u64;
            link
        } else {
            self.foreign(plug, wire, message, at)
        };
        link.above = !new;
        if new && depth < STEPS_MAX {
            if plug == 0 {
                self.explain(&mut link, message, depth);
            } else {
                self.explain_foreign(plug, &mut link, message, depth);
            }
        }
        link
    }

    fn foreign(&self, plug: u32, wire: &str, message: &Message, at: Time) -> Link {
        let plugged = self
            .recording
            .plugs
            .iter()
            .find(|(_, p)| p.number == plug)
            .map(|(_, p)| p);
        let output = plugged.and_then(|p| p.plug.outputs.iter().find(|o| o.name == wire));
        let slot = output.map(|o| crate::manifest::Slot {
            name: o.name.clone(),
            kind: o.kind,
            unit: o.unit.clone(),
        });
        let mut link = self.bare(wire, message, at, slot.as_ref());
        link.traced = false;
        link.module = wire.split_once('.').map(|(module, _)| module.to_string());
        if let Some(plugged) = plugged {
            link.layer = plugged.plug.layer.clone();
            link.level = Some(plugged.plug.level);
            link.pid = Some(plugged.plug.pid);
        }
        link
    }

    /// The registers of the module that wrote it, at the beat that did.
    fn explain(&mut self, link: &mut Link, message: &Message, depth: usize) {
        let Some(module) = link.module.clone() else { return };
        let Some((source, _)) = self.recording.manifest.writer_of(&link.wire) else {
            return;
        };
        let Some((index, traced)) = self.beat_at(source, message.stamp) else {
            return;
        };
        link.traced = traced;
        let inputs = &self.recording.manifest.sources[source].inputs;
        let of_module = |name: &str| name.split_once('.').is_some_and(|(m, _)| m == module);
        let slots: Vec<usize> = (0..inputs.len())
            .filter(|&s| of_module(&inputs[s].name))
            .collect();
        link.inputs = slots
            .into_iter()
            .filter_map(|slot| self.input(source, slot, index, depth))
            .collect();
    }

    /// What stood on the wires into the module of a layer process, by their stamps.
    fn explain_foreign(&mut self, plug: u32, link: &mut Link, message: &Message, depth: usize) {
        let Some(module) = link.module.clone() else { return };
        let Some((_, plugged)) = self.recording.plugs.iter().find(|(_, p)| p.number == plug) else {
            return;
        };
        let of_module = |port: &str| port.split_once('.').is_some_and(|(m, _)| m == module);
        let wires = plugged.plug.wires.iter();
        let mut ports: Vec<(String, Option<String>)> = wires
            .filter(|(_, to)| of_module(to))
            .map(|(from, to)| (to.clone(), Some(from.clone())))
            .collect();
        for (_, tap) in self.recording.taps() {
            if tap.how == How::Suppress && of_module(&tap.to) && ports.iter().all(|(to, _)| *to != tap.to) {
                ports.push((tap.to, None));
            }
        }
        for (port, wire) in ports {
            link.inputs
                .push(self.foreign_input(port, wire.as_deref(), message.stamp, depth));
        }
    }

    /// What the input `port` of a layer process held at `now`, by the stamps of the wire into it and of the taps on
    /// it: the rules are the same there, only nobody wrote down which message was looked at.
    fn foreign_input(&mut self, port: String, wire: Option<&str>, now: Time, depth: usize) -> Input {
        let recording = self.recording;
        // What came at the very moment was written by others in the same beat, or later.
        let at = now - Span::nanos(1);
        let own = wire.and_then(|wire| Some((wire.to_string(), newest(recording, wire, at)?)));
        let on_port = |t: &(u32, Tap)| t.1.to == port && t.1.how == How::Suppress;
        let mut taps: Vec<(u32, Tap)> = recording.taps().filter(on_port).collect();
        taps.sort_by_key(|(_, tap)| tap.level);
        let said = |(plug, tap): &(u32, Tap)| {
            let messages = recording.wires.get(&(*plug, tap.from.clone()))?;
            before(messages, at).copied()
        };
        let said: Vec<Option<Message>> = taps.iter().map(said).collect();
        let windows = taps.iter().zip(&said).map(|((_, tap), said)| {
            said.map(|m| Window {
                stamp: m.stamp,
                time_constant: tap.time_constant,
            })
        });
        let holder = ipc::tap::holder(own.as_ref().map(|(_, (_, m))| m.stamp), windows);
        let standing = taps.iter().zip(&said);
        let standing = standing.map(|((_, tap), said)| tap_seen(tap, said.map(|m| m.stamp), at));
        let standing: Vec<TapSeen> = standing.filter(|seen| seen.age_ms.is_some()).collect();
        let (tap, held) = match (holder, own) {
            (Some(0), Some((wire, (plug, m)))) => (None, Some((plug, wire, m))),
            (Some(k), _) if k > 0 => {
                let (plug, tap) = &taps[k - 1];
                let held = said[k - 1].map(|m| (*plug, tap.from.clone(), m));
                (Some(tap.layer.clone()), held)
            }
            _ => (None, None),
        };
        let held = held.map(|(plug, wire, m)| Box::new(self.link(plug, &wire, &m, now, depth + 1)));
        Input {
            port,
            arrived: false,
            tap,
            taps: standing,
            rejected: 0,
            newest_rejected: None,
            held,
        }
    }

    /// The beat that wrote what is stamped `stamp`, or else the newest before it.
    fn beat_at(&self, source: usize, stamp: Time) -> Option<(usize, bool)> {
        let beats = &self.recording.beats[source];
        let index = beats.partition_point(|b| b.commit_ns <= stamp.0).checked_sub(1)?;
        Some((index, !beats[index].base && beats[index].commit_ns == stamp.0))
    }

    /// What the register in `slot` held in beat `index`; `None` if nothing leads to it.
    fn input(&mut self, source: usize, slot: usize, index: usize, depth: usize) -> Option<Input> {
        let recording = self.recording;
        let port = recording.manifest.sources[source].inputs[slot].name.clone();
        let wire = recording.manifest.wire_into(&port).map(str::to_string);
        let beats = &recording.beats[source][..=index];
        let now = Time(beats[index].step_ns);
        let on_port = |t: &(u32, Tap)| t.1.to == port && t.1.how == How::Suppress;
        let taps: Vec<(u32, Tap)> = recording.taps().filter(on_port).collect();
        if wire.is_none() && taps.is_empty() {
            return None;
        }
        let own = beats.iter().enumerate().rev().find_map(|(i, beat)| {
            let number = beat.saw.iter().find(|(s, _)| *s == slot)?.1;
            Some((i, number))
        });
        let own = own.zip(wire.as_deref()).and_then(|((i, number), wire)| {
            Some((i, 0, wire.to_string(), *recording.message(0, wire, number)?, None))
        });
        let seen = |tap: &Tap| {
            beats.iter().enumerate().rev().find_map(|(i, beat)| {
                let taken = |t: &TapMessage| t.tap == tap.number && t.fate != Fate::Fault;
                Some((i, beat.tap_messages().find(taken)?))
            })
        };
        let mut standing = Vec::new();
        let mut held = own;
        for (plug, tap) in &taps {
            let found = seen(tap);
            standing.push(tap_seen(tap, found.map(|(_, m)| m.stamp), now));
            let Some((i, message)) = found.filter(|(_, m)| m.fate == Fate::Delivered) else {
                continue;
            };
            let Some(brought) = recording.message(*plug, &tap.from, message.number) else {
                continue;
            };
            if held.as_ref().is_none_or(|(.., m, _)| message.stamp >= m.stamp) {
                held = Some((i, *plug, tap.from.clone(), *brought, Some(tap.layer.clone())));
            }
        }
        let since = held.as_ref().map_or(0, |(i, ..)| *i);
        let mut kept_out = beats[since..]
            .iter()
            .flat_map(|b| &b.rejected)
            .filter(|(s, _)| *s == slot);
        let rejected = kept_out.clone().count() as u64;
        let newest_rejected = wire
            .as_ref()
            .zip(kept_out.next_back())
            .map(|(wire, &(_, number))| {
                let message = recording.message(0, wire, number);
                let kind = recording.manifest.sources[source].inputs[slot].kind;
                Rejected {
                    wire: wire.clone(),
                    number,
                    age_ms: message.map(|m| now.since(m.stamp).as_millis_f64()),
                    value: message.map_or(Vec::new(), |m| m.words[..kind.words()].to_vec()),
                }
            });
        let arrived = held.as_ref().is_some_and(|(i, ..)| *i == index);
        let tap = held.as_ref().and_then(|(.., tap)| tap.clone());
        let held = held
            .map(|(_, plug, wire, message, _)| Box::new(self.link(plug, &wire, &message, now, depth + 1)));
        Some(Input {
            port,
            arrived,
            tap,
            taps: standing,
            rejected,
            newest_rejected,
            held,
        })
    }
}

fn tap_seen(tap: &Tap, newest: Option<Time>, now: Time) -> TapSeen {
    let window = newest.map(|stamp| Window {
        stamp,
        time_constant: tap.time_constant,
    });
    let left = window.map_or(Span::ZERO, |w| w.remaining(now));
    TapSeen {
        layer: tap.layer.clone(),
        level: tap.level,
        from: tap.from.clone(),
        kind: tap.how,
        holds: left > Span::ZERO,
        left_ms: left.as_millis_f64(),
        age_ms: newest.map(|stamp| now.since(stamp).as_millis_f64()),
    }
}
