//! A player: one layer (or the motor unit's registers) run again beat by beat.
//!
//! Must never share a cell between two registers: each finds what it found then, whatever its neighbours found.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::layer::{Command, Hand, RunningLayer};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, WORDS_MAX, Words};
use ipc::wire::{Fate, Page, Reader, Register, Room, TapEnd, TapGauge, Writer};
use ipc::wiring::creature::How;
use recording::Recording;
use recording::reader::{Beat, Message};

use crate::body::BodyKind;
use crate::gate::{Causes, Passage};
use crate::motor::gated;

/// Most taps that may join one layer during a recording; each gets a cell of its own.
pub(super) const JOINS_MAX: usize = 1024;

/// Where a register or tap gets its messages from.
pub(super) enum Origin {
    /// From the recording: the number of the attached layer, 0 for the creature, and the wire.
    Recorded(u32, String),
    /// From a player's output.
    Replayed(usize, usize),
}

/// What a cell stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// A register's own wire, by the slot that the recording gives it, if it knows it.
    Register(Option<usize>),
    /// A tap, by the number that the recording gives it, if it knows it.
    Tap(Option<u16>),
}

/// A cell that one register or tap looks at.
pub(super) struct Feed {
    pub(super) origin: Origin,
    pub(super) look: Look,
    pub(super) cell: Writer,
    /// Number of the newest recorded message that was seen.
    pub(super) seen: u64,
    /// How many of the replayed messages were passed on.
    pub(super) fed: usize,
}

impl Feed {
    pub(super) fn put(&mut self, message: &Message) {
        self.cell.write(message.stamp, &message.words);
    }
}

/// An output that is compared.
pub(super) struct Output {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) reader: Option<Reader>,
    pub(super) seen: u64,
    /// The beat that wrote each recorded message, by its number.
    pub(super) beats: HashMap<u64, u64>,
}

pub(super) enum Seat {
    Layer(Box<RunningLayer>, Hand),
    Motor(&'static BodyKind, Vec<Register>),
}

/// One source being run again.
pub(super) struct Player {
    pub(super) outputs: Vec<Output>,
    pub(super) beats: Vec<Beat>,
    pub(super) feeds: Vec<Feed>,
    pub(super) done: usize,
    pub(super) busy: bool,
    pub(super) seat: Seat,
    /// Whether its beats are the recorded ones.
    pub(super) traced: bool,
    /// Cells for taps that join later.
    pub(super) spare: Arc<Page>,
    pub(super) joined: usize,
}

impl Output {
    /// The recorded messages of this output, by beat; `None` if the recording does not know it.
    pub(super) fn recorded<'r>(
        &'r self,
        recording: &'r Recording,
        player: &'r Player,
    ) -> Option<Box<dyn Iterator<Item = (u64, Words)> + 'r>> {
        if !player.traced {
            return None;
        }
        if matches!(player.seat, Seat::Motor(..)) {
            let messages = recording.commands.get(&self.name)?;
            let first = player.beats.iter().find(|b| !b.base)?.number;
            return Some(Box::new(
                messages
                    .iter()
                    .filter(move |m| m.number >= first)
                    .map(|m| (m.number, m.words)),
            ));
        }
        recording.manifest.writer_of(&self.name)?;
        let messages = recording.wires.get(&(0, self.name.clone())).into_iter().flatten();
        Some(Box::new(
            messages.filter_map(|m| Some((*self.beats.get(&m.number)?, m.words))),
        ))
    }
}

impl Player {
    /// The next beat to be run.
    pub(super) fn next(&self) -> Option<&Beat> {
        self.beats.get(self.done)
    }

    /// Whether the recording says which beat wrote message `number` of an output.
    pub(super) fn knows(&self, output: usize, number: u64) -> bool {
        self.outputs[output].beats.contains_key(&number)
    }

    /// What the recording says a feed's register or tap looked at in this beat.
    pub(super) fn looked(&self, feed: usize, beat: &Beat) -> Option<(u64, Fate)> {
        if !self.traced {
            return None;
        }
        match self.feeds[feed].look {
            Look::Register(slot) => {
                let found = beat.looks().find(|(s, ..)| Some(*s) == slot)?;
                Some((found.1, found.2))
            }
            Look::Tap(tap) => {
                let found = beat.tap_messages().find(|t| Some(t.tap) == tap)?;
                Some((found.number, found.fate))
            }
        }
    }

    /// Up to which beat of `writer` a feed had seen what that wrote, when this beat looked.
    pub(super) fn horizon(&self, feed: usize, beat: &Beat, writer: &Player) -> Option<u64> {
        let by_time = writer.beats.partition_point(|b| b.commit_ns <= beat.step_ns);
        let by_time = by_time.checked_sub(1).map(|i| writer.beats[i].number);
        let Feed {
            look,
            origin: Origin::Replayed(_, output),
            seen,
            ..
        } = &self.feeds[feed]
        else {
            return None;
        };
        let traced = self.traced && writer.traced && !matches!(look, Look::Register(None) | Look::Tap(None));
        if !traced {
            return by_time;
        }
        let seen = self.looked(feed, beat).map_or(*seen, |(number, _)| number);
        let beats = &writer.outputs[*output].beats;
        let at_least = beats.get(&seen).copied();
        let before = beats.get(&(seen + 1)).copied();
        let by_time = match before {
            Some(before) => by_time
                .map(|t| t.min(before.saturating_sub(1)))
                .filter(|_| before > 0),
            None => by_time,
        };
        at_least.max(by_time)
    }

    /// Makes cells for the taps that joined in this beat, and passes the news on.
    pub(super) fn note_joined(&mut self, beat: &Beat, recording: &Recording) {
        let Seat::Layer(_, hand) = &mut self.seat else {
            return;
        };
        for &plug in &beat.released {
            let _ = hand.commands.push(Command::Release(plug));
        }
        for joined in &beat.joined {
            let tap = recording
                .taps()
                .find(|(plug, t)| *plug == joined.plug && t.number == joined.tap);
            let Some((plug, tap)) = tap else { continue };
            let outputs = recording.plugs.iter().filter(|(_, p)| p.number == plug);
            let kind = outputs
                .flat_map(|(_, p)| &p.plug.outputs)
                .find(|o| o.name == tap.from)
                .map(|o| o.kind);
            let (Some(kind), true) = (kind, self.joined < JOINS_MAX) else {
                continue;
            };
            let (cell, reader) = (
                self.spare.writer(self.joined, kind),
                self.spare.reader(self.joined, kind),
            );
            let (Some(cell), Some(reader)) = (cell, reader) else {
                continue;
            };
            self.joined += 1;
            self.feeds.push(Feed {
                origin: Origin::Recorded(plug, tap.from),
                look: Look::Tap(Some(joined.tap)),
                cell,
                seen: 0,
                fed: 0,
            });
            let room = Room::full(reader.kind());
            let end = TapEnd {
                reader,
                time_constant: Span(joined.time_constant_ns),
                level: joined.level,
                plug,
                gauge: Arc::new(TapGauge::numbered(joined.tap)),
                room,
            };
            let _ = hand.commands.push(match joined.how {
                How::Suppress => Command::Suppress(joined.slot, end),
                How::Inhibit => Command::Inhibit(joined.slot, end),
            });
        }
    }

    /// Runs a beat; gives what it wrote, by output.
    pub(super) fn run(&mut self, beat: &Beat) -> Vec<(usize, Words)> {
        let (step, commit) = (Time(beat.step_ns), Time(beat.commit_ns));
        if beat.base {
            return Vec::new();
        }
        match &mut self.seat {
            Seat::Layer(running, hand) => {
                running.step(step);
                running.commit(commit);
                while hand.returned.pop().is_ok() {}
                let mut written = Vec::new();
                for (index, output) in self.outputs.iter_mut().enumerate() {
                    let reading = output.reader.as_ref().and_then(|r| r.newer_than(output.seen));
                    if let Some(reading) = reading {
                        output.seen = reading.number;
                        written.push((index, reading.words));
                    }
                }
                written
            }
            Seat::Motor(kind, registers) => {
                let causes = Causes(beat.causes.unwrap_or(0));
                pass(kind, registers, step, Passage::for_causes(causes))
            }
        }
    }
}

/// What the motor unit passes on to the body in one beat.
fn pass(
    kind: &'static BodyKind,
    registers: &mut [Register],
    now: Time,
    passage: Passage,
) -> Vec<(usize, Words)> {
    let mut passed = Vec::new();
    for (index, register) in registers.iter_mut().enumerate() {
        register.gather(now, std::mem::forget);
        let motion = kind.motion.contains(&index);
        let words = match register.held() {
            Some((_, words)) if motion => gated(kind, index, words, passage),
            Some((_, words)) if register.arrived() => words,
            _ if motion => [0.0; WORDS_MAX],
            _ => continue,
        };
        passed.push((index, words));
    }
    passed
}
