//! A player: one layer (or the motor unit's registers) run again beat by beat.
//!
//! Must never share a cell between two registers: each finds what it found then, whatever its neighbours found.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble, join};
use afsm::layer::{Command, Hand, RunningLayer};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, WORDS_MAX, Words};
use ipc::wire::{Fate, Page, Reader, Register, Room, TapEnd, TapGauge, Writer};
use ipc::wiring::catalog;
use ipc::wiring::creature::{BODY, Creature, How, Layer, PortName};
use recording::Recording;
use recording::manifest::MOTOR;
use recording::reader::{Beat, Message};

use crate::body::{self, BodyKind};
use crate::gate::{Causes, Passage};
use crate::machine::filed_taps;
use crate::motor::gated;

/// Most taps that may join one layer during a recording; each gets a cell of its own.
const JOINS_MAX: usize = 1024;

/// Where a register or tap gets its messages from.
pub(super) enum Origin {
    /// From the recording: the number of the attached layer, 0 for the creature, and the wire.
    Recorded(u32, String),
    /// From a player's output.
    Replayed(usize, usize),
}

/// What a cell stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    /// A register's own wire, by the slot that the recording gives it, if it knows it.
    Register(Option<usize>),
    /// A tap, by the number that the recording gives it, if it knows it.
    Tap(Option<u16>),
}

/// A cell that one register or tap looks at.
pub(super) struct Feed {
    pub(super) origin: Origin,
    look: Look,
    cell: Writer,
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
    reader: Option<Reader>,
    seen: u64,
    /// The beat that wrote each recorded message, by its number.
    beats: HashMap<u64, u64>,
}

enum Seat {
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
    seat: Seat,
    /// Whether its beats are the recorded ones.
    traced: bool,
    /// Cells for taps that join later.
    spare: Arc<Page>,
    joined: usize,
}

/// Hands out a fresh cell for each register and tap, in the order of assembly.
struct Cells<'c> {
    page: Arc<Page>,
    kinds: &'c HashMap<PortName, Kind>,
    given: std::cell::RefCell<Vec<(PortName, Writer)>>,
}

impl Wires for Cells<'_> {
    fn reader(&self, output: &PortName) -> Option<Reader> {
        let kind = *self.kinds.get(output)?;
        let mut given = self.given.borrow_mut();
        let index = given.len();
        let cell = self
            .page
            .writer(index, kind)
            .expect("the page has a cell for each look");
        given.push((output.clone(), cell));
        self.page.reader(index, kind)
    }
}

/// The layers of `creature`, and its motor unit, ready to be run through `recording`.
pub(super) fn players(recording: &Recording, creature: &Creature, kinds: &Kinds) -> Vec<Player> {
    let outputs = ipc::wiring::directory::output_ports(creature);
    let kind_of: HashMap<PortName, Kind> = outputs.map(|(name, port, _)| (name, port.kind)).collect();
    // Sensors are not played: they come from the recording.
    let mut writers = HashMap::new();
    for (player, layer) in creature.layers.iter().enumerate() {
        for (output, (name, _)) in outputs_of(layer).enumerate() {
            writers.insert(name, (player, output));
        }
    }
    let taps = filed_taps(creature);
    let build = Build {
        recording,
        creature,
        kind_of,
        writers,
        taps,
    };
    let mut players: Vec<Player> = creature.layers.iter().map(|l| build.layer(l, kinds)).collect();
    players.extend(build.motor());
    players
}

fn outputs_of(layer: &Layer) -> impl Iterator<Item = (PortName, Kind)> {
    layer.modules.iter().flat_map(|m| {
        let name = |port: &str| PortName {
            module: m.name.clone(),
            port: port.into(),
        };
        m.declaration.outputs.iter().map(move |p| (name(p.name), p.kind))
    })
}

struct Build<'b> {
    recording: &'b Recording,
    creature: &'b Creature,
    kind_of: HashMap<PortName, Kind>,
    writers: HashMap<PortName, (usize, usize)>,
    taps: Vec<FiledTap>,
}

impl Build<'_> {
    fn cells(&self, registers: usize) -> Cells<'_> {
        Cells {
            page: Page::in_memory(registers + 2 * self.taps.len()),
            kinds: &self.kind_of,
            given: Default::default(),
        }
    }

    fn layer(&self, layer: &Layer, kinds: &Kinds) -> Player {
        let outputs: Vec<_> = outputs_of(layer).collect();
        let page = Page::in_memory(outputs.len());
        let inputs: Vec<PortName> = inputs_of(layer).collect();
        let cells = self.cells(inputs.len());
        let (running, hand) = assemble(layer, kinds, &page, 0, &cells, &self.taps, self.creature.seed);
        let mut looks = Vec::new();
        // In the order of assembly: module by module, a register's wire, its suppressors, then inhibitors.
        for module in &layer.modules {
            let of_module = inputs.iter().filter(|i| i.module == module.name);
            for input in of_module {
                if layer.wires.iter().any(|w| w.to == *input) {
                    looks.push(self.register(&layer.name, input));
                }
                looks.extend(self.taps_on(How::Suppress, input));
            }
            for output in outputs.iter().filter(|(name, _)| name.module == module.name) {
                looks.extend(self.taps_on(How::Inhibit, &output.0));
            }
        }
        let recorded = self.recording.manifest.source(&layer.name);
        let known = recorded.filter(|&s| self.recording.manifest.sources[s].period == layer.period);
        let beats = known.map_or_else(|| self.invent_beats(layer), |s| self.recording.beats[s].clone());
        let outputs = outputs
            .into_iter()
            .enumerate()
            .map(|(index, (name, kind))| Output {
                name: name.to_string(),
                kind,
                reader: page.reader(index, kind),
                seen: 0,
                beats: self.beats_of(&name.to_string(), &beats),
            });
        Player {
            outputs: outputs.collect(),
            feeds: self.feeds(cells, looks),
            done: 0,
            busy: false,
            seat: Seat::Layer(Box::new(running), hand),
            traced: known.is_some(),
            spare: Page::in_memory(JOINS_MAX),
            joined: 0,
            beats,
        }
    }

    fn motor(&self) -> Option<Player> {
        let spec = self.creature.body.as_ref()?;
        let kind = body::find(spec.declaration.name)?;
        let source = self.recording.motor()?;
        let inputs = kind.declaration.inputs;
        let cells = self.cells(inputs.len());
        let (mut registers, mut looks) = (Vec::new(), Vec::new());
        for port in inputs {
            let name = PortName {
                module: BODY.into(),
                port: port.name.into(),
            };
            let wires = self.creature.layers.iter().flat_map(|l| &l.wires);
            let wire = wires.clone().find(|w| w.to == name);
            let mut register = Register::new(port.limits(), wire.and_then(|w| cells.reader(&w.from)));
            if wire.is_some() {
                looks.push(self.register(MOTOR, &name));
            }
            join(&self.taps, How::Suppress, &name, &cells, |end| {
                register.suppress(end)
            });
            looks.extend(self.taps_on(How::Suppress, &name));
            registers.push(register);
        }
        let beats = self.recording.beats[source].clone();
        let outputs = inputs.iter().map(|port| Output {
            name: format!("{BODY}.{}", port.name),
            kind: port.kind,
            reader: None,
            seen: 0,
            beats: HashMap::new(),
        });
        Some(Player {
            outputs: outputs.collect(),
            feeds: self.feeds(cells, looks),
            done: 0,
            busy: false,
            seat: Seat::Motor(kind, registers),
            traced: true,
            spare: Page::in_memory(1),
            joined: 0,
            beats,
        })
    }

    /// A register, by the slot that the recording gives it if it has the same wire there.
    fn register(&self, source: &str, port: &PortName) -> Look {
        let (manifest, port) = (&self.recording.manifest, port.to_string());
        let wires = self.creature.layers.iter().flat_map(|l| &l.wires);
        let wire = wires
            .clone()
            .find(|w| w.to.to_string() == port)
            .map(|w| w.from.to_string());
        let found = manifest
            .register_of(&port)
            .filter(|(s, _)| manifest.sources[*s].name == source);
        let same = manifest.wire_into(&port) == wire.as_deref();
        Look::Register(found.filter(|_| same).map(|(_, slot)| slot))
    }

    fn taps_on(&self, how: How, port: &PortName) -> Vec<Look> {
        let on = self.taps.iter().filter(|t| t.tap.how == how && t.tap.to == *port);
        let recorded = |t: &FiledTap| {
            let same = |r: &&recording::manifest::Tap| {
                r.how == how && r.to == t.tap.to.to_string() && r.from == t.tap.from.to_string()
            };
            self.recording.manifest.taps.iter().find(same).map(|r| r.number)
        };
        on.map(|t| Look::Tap(recorded(t))).collect()
    }

    fn feeds(&self, cells: Cells<'_>, looks: Vec<Look>) -> Vec<Feed> {
        let given = cells.given.into_inner();
        assert_eq!(given.len(), looks.len(), "every cell stands for one look");
        let origin = |wire: &PortName| match self.writers.get(wire) {
            Some(&(player, output)) => Origin::Replayed(player, output),
            None => Origin::Recorded(0, wire.to_string()),
        };
        let pairs = given.into_iter().zip(looks);
        pairs
            .map(|((wire, cell), look)| Feed {
                origin: origin(&wire),
                look,
                cell,
                seen: 0,
                fed: 0,
            })
            .collect()
    }

    /// The beat that wrote each recorded message of a wire: the one that its stamp is of.
    fn beats_of(&self, wire: &str, beats: &[Beat]) -> HashMap<u64, u64> {
        let by_commit: HashMap<u64, u64> = beats
            .iter()
            .filter(|b| !b.base)
            .map(|b| (b.commit_ns, b.number))
            .collect();
        let messages = self
            .recording
            .wires
            .get(&(0, wire.to_string()))
            .into_iter()
            .flatten();
        messages
            .filter_map(|m| Some((m.number, *by_commit.get(&m.stamp.0)?)))
            .collect()
    }

    /// The beats of a layer that the recording does not know: on the dot.
    fn invent_beats(&self, layer: &Layer) -> Vec<Beat> {
        let Some((first, last)) = self.recording.stretch() else {
            return Vec::new();
        };
        let time = |k: u64| first + layer.phase + Span(k * layer.period.0);
        let beat = |k: u64| Beat {
            number: k,
            step_ns: time(k).0,
            commit_ns: time(k).0,
            base: false,
            saw: Vec::new(),
            rejected: Vec::new(),
            faults: Vec::new(),
            taps: Vec::new(),
            joined: Vec::new(),
            released: Vec::new(),
            dropped: Vec::new(),
            causes: None,
        };
        (0..).map(beat).take_while(|b| b.commit_ns <= last.0).collect()
    }
}

fn inputs_of(layer: &Layer) -> impl Iterator<Item = PortName> {
    layer.modules.iter().flat_map(|m| {
        let inputs = m.declaration.inputs.iter().chain([&catalog::RESET]);
        inputs.map(|p| PortName {
            module: m.name.clone(),
            port: p.name.into(),
        })
    })
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
            let end = TapEnd {
                reader,
                time_constant: Span(joined.time_constant_ns),
                level: joined.level,
                plug,
                gauge: Arc::new(TapGauge::numbered(joined.tap)),
                room: Room::full(),
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
            Some((_, words)) if motion => gated(kind, index, *words, passage),
            Some((_, words)) if register.arrived() => *words,
            _ if motion => [0.0; WORDS_MAX],
            _ => continue,
        };
        passed.push((index, words));
    }
    passed
}
