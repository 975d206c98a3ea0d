//! Builds players: each layer of the creature, with a cell of its own behind every register and tap.
//!
//! Must never mix up whom a cell belongs to: cells are handed out in the order of assembly, which is checked.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble, join};
use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wire::{Page, Reader, Register, Writer};
use ipc::wiring::catalog;
use ipc::wiring::creature::{BODY, Creature, How, Layer, PortName};
use recording::Recording;
use recording::manifest::MOTOR;
use recording::reader::Beat;

use super::player::{Feed, JOINS_MAX, Look, Origin, Output, Player, Seat};
use crate::body;
use crate::machine::filed_taps;

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
