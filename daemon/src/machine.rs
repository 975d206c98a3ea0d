//! The machine: a checked creature with everything allocated that it needs to run, not yet running.
//!
//! The same machine is stepped on the virtual clock in one thread, or taken apart and given to
//! real-time threads.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble};
use afsm::layer::{Hand, RunningLayer};
use ipc::wire::{Page, Reader, TapGauge};
use ipc::wiring::creature::{Creature, Layer, PortName};
use ipc::wiring::directory::output_ports;

use crate::body::{self, Place, World, WorldEnd};
use crate::executor::gauge::BeatGauge;
use crate::motor::{HaltChannel, Motor};

/// The kinds that this daemon was built with.
pub fn kinds() -> Kinds {
    let bodies = body::BODIES.iter().map(|k| k.declaration);
    Kinds::default()
        .with(allen::MODULES.iter().copied())
        .with_bodies(bodies)
}

/// A layer ready to run.
#[derive(Debug)]
pub struct Station {
    /// As checked.
    pub spec: Layer,
    /// Its modules.
    pub running: RunningLayer,
    /// Its counters.
    pub gauge: Arc<BeatGauge>,
}

/// A body ready to run.
pub struct Embodied {
    /// The motor unit.
    pub motor: Motor,
    /// The world behind it.
    pub world: Box<dyn World>,
    /// The world's end of the link.
    pub link: WorldEnd,
    /// The motor unit's counters.
    pub gauge: Arc<BeatGauge>,
}

/// A creature ready to run.
pub struct Machine {
    /// As checked.
    pub creature: Creature,
    /// The cells of all its wires, in the order of [`output_ports`].
    pub page: Arc<Page>,
    /// Its layers, lowest level first.
    pub stations: Vec<Station>,
    /// How to reach into each layer.
    pub hands: Vec<Hand>,
    /// Its body, if it has one.
    pub body: Option<Embodied>,
    /// The taps of its file.
    pub taps: Vec<FiledTap>,
    /// The halt channel.
    pub halt: Arc<HaltChannel>,
}

/// The wires of one process by name.
#[derive(Debug)]
pub struct Net {
    page: Arc<Page>,
    index: HashMap<PortName, (usize, ipc::message::Kind)>,
}

impl Net {
    /// The wires of `creature` in `page`.
    pub fn new(creature: &Creature, page: &Arc<Page>) -> Net {
        let numbered = output_ports(creature).enumerate();
        let index = numbered
            .map(|(i, (name, port, _))| (name, (i, port.kind)))
            .collect();
        Net {
            page: page.clone(),
            index,
        }
    }
}

impl Wires for Net {
    fn reader(&self, output: &PortName) -> Option<Reader> {
        let (index, kind) = self.index.get(output)?;
        self.page.reader(*index, *kind)
    }
}

impl Machine {
    /// Builds `creature` on the wires of `page`, which has one cell for each of its [`output_ports`].
    /// `start` is where the body starts, if a test wants a certain place.
    ///
    /// # Panics
    /// When the creature was not checked against `kinds`.
    pub fn new(creature: Creature, kinds: &Kinds, page: Arc<Page>, start: Option<Place>) -> Machine {
        let net = Net::new(&creature, &page);
        let taps = filed_taps(&creature);
        let mut next = creature.body.as_ref().map_or(0, |b| b.declaration.outputs.len());
        let sensors_end = next;
        let mut stations = Vec::new();
        let mut hands = Vec::new();
        for layer in &creature.layers {
            let (running, hand) = assemble(layer, kinds, &page, next, &net, &taps, creature.seed);
            next += layer
                .modules
                .iter()
                .map(|m| m.declaration.outputs.len())
                .sum::<usize>();
            stations.push(Station {
                spec: layer.clone(),
                running,
                gauge: Arc::default(),
            });
            hands.push(hand);
        }
        let halt = Arc::new(HaltChannel::default());
        let gauges: Vec<_> = stations.iter().map(|s| s.gauge.clone()).collect();
        let body = creature.body.as_ref().map(|spec| {
            let kind = body::find(spec.declaration.name).expect("a checked body is of a known kind");
            let (motor_end, link) = body::link(spec.declaration);
            let sensor = |i: usize| {
                page.writer(i, spec.declaration.outputs[i].kind)
                    .expect("one writer")
            };
            let sensors = (0..sensors_end).map(sensor).collect();
            let motor = Motor::new(&creature, motor_end, sensors, &net, &taps, &gauges, halt.clone());
            let world = (kind.build)(&spec.settings, creature.seed, start);
            Embodied {
                motor,
                world,
                link,
                gauge: Arc::default(),
            }
        });
        Machine {
            creature,
            page,
            stations,
            hands,
            body,
            taps,
            halt,
        }
    }
}

/// The taps of a creature file, numbered from 1 in its order.
pub fn filed_taps(creature: &Creature) -> Vec<FiledTap> {
    let of = |layer: &Layer| {
        let level = layer.level;
        let taps = layer.taps.clone();
        taps.into_iter().map(move |tap| (tap, level))
    };
    let numbered = creature.layers.iter().flat_map(of).zip(1..);
    numbered
        .map(|((tap, level), number)| FiledTap {
            tap,
            level,
            gauge: Arc::new(TapGauge::numbered(number)),
        })
        .collect()
}
