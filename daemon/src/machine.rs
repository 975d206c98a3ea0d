//! The machine: a checked creature with everything allocated that it needs to run, not yet running.
//!
//! The same machine is stepped on the virtual clock in one thread, or taken apart and given to
//! real-time threads.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble};
use afsm::layer::{Hand, RunningLayer};
use ipc::clock::Span;
use ipc::wire::{Page, Reader, TapGauge};
use ipc::wiring::creature::{Creature, Layer, Overrun, PortName};
use ipc::wiring::directory::output_ports;

use crate::body::handover::Giver;
use crate::body::link::{SensorReaders, motor_end};
use crate::body::{self, MotorEnd, Place, World, WorldEnd};
use crate::executor::gauge::BeatGauge;
use crate::halt::HaltChannel;
use crate::motor::Motor;
use crate::watchdog::{Strict, Thaw, Vital, Watchdog};

/// The kinds that this daemon was built with.
pub fn kinds() -> Kinds {
    let bodies = body::BODIES.iter().map(|k| k.declaration);
    Kinds::default()
        .with(stock::modules())
        .with(allen::MODULES.iter().copied())
        .with(mechanisms::MODULES.iter().copied())
        .with([&truckin::wired::KIND])
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

/// The motor unit of a body in another process, ready to run.
#[derive(Debug)]
pub struct Apart {
    /// The motor unit.
    pub motor: Motor,
    /// The motor unit's counters.
    pub gauge: Arc<BeatGauge>,
    /// Hands the other process's sensors to the motor unit.
    pub giver: Giver<SensorReaders>,
    /// The cell of the page in which the first command is.
    pub first: usize,
}

/// A creature ready to run.
pub struct Machine {
    /// As checked.
    pub creature: Creature,
    /// The cells of all its wires, in the order of [`output_ports`]; then commands to a body apart.
    pub page: Arc<Page>,
    /// Its layers, lowest level first.
    pub stations: Vec<Station>,
    /// How to reach into each layer.
    pub hands: Vec<Hand>,
    /// Its body, if it has one and it lives in this process.
    pub body: Option<Embodied>,
    /// Its body, if it lives in another process.
    pub apart: Option<Apart>,
    /// The taps of its file.
    pub taps: Vec<FiledTap>,
    /// The halt channel.
    pub halt: Arc<HaltChannel>,
    /// Looks after all of it.
    pub watchdog: Watchdog,
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

/// How many cells the page of a creature has whose body lives in another process: its wires, then the
/// commands to its body.
pub fn cells_apart(creature: &Creature) -> usize {
    let commands = creature.body.as_ref().map_or(0, |b| b.declaration.inputs.len());
    output_ports(creature).count() + commands
}

impl Machine {
    /// Builds `creature` on the wires of `page`, which has one cell for each of its [`output_ports`].
    /// `start` is where the body starts, if a test wants a certain place.
    ///
    /// # Panics
    /// When the creature was not checked against `kinds`.
    pub fn new(creature: Creature, kinds: &Kinds, page: Arc<Page>, start: Option<Place>) -> Machine {
        let mut machine = Machine::without_body(creature, kinds, page);
        let Some(spec) = machine.creature.body.clone() else {
            return machine;
        };
        let kind = body::find(spec.declaration.name).expect("a checked body is of a known kind");
        let (motor_end, link) = body::link(kind);
        let (motor, gauge) = machine.embody(motor_end);
        let world = (kind.build)(&spec.settings, machine.creature.seed, start);
        machine.body = Some(Embodied {
            motor,
            world,
            link,
            gauge,
        });
        machine
    }

    /// The same with the body in another process; `page` has [`cells_apart`].
    ///
    /// # Panics
    /// When the creature was not checked against `kinds`, or has no body.
    pub fn apart(creature: Creature, kinds: &Kinds, page: Arc<Page>) -> Machine {
        let mut machine = Machine::without_body(creature, kinds, page);
        let body = machine.creature.body.as_ref().expect("the creature has a body");
        let first = output_ports(&machine.creature).count();
        let (motor_end, giver) = motor_end(body.declaration, &machine.page, first);
        let (motor, gauge) = machine.embody(motor_end);
        machine.apart = Some(Apart {
            motor,
            gauge,
            giver,
            first,
        });
        machine
    }

    fn without_body(creature: Creature, kinds: &Kinds, page: Arc<Page>) -> Machine {
        let net = Net::new(&creature, &page);
        let taps = filed_taps(&creature);
        let mut next = creature.body.as_ref().map_or(0, |b| b.declaration.outputs.len());
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
        let vital = stations.iter().filter(|s| s.spec.vital);
        let strict = stations.iter().filter(|s| s.spec.overrun == Overrun::Halt);
        let period = creature.body.as_ref().map_or(Span::ZERO, |b| b.period);
        let watchdog = Watchdog {
            vital: vital
                .map(|s| Vital::new(&s.spec.name, s.gauge.clone(), s.spec.period))
                .collect(),
            strict: strict
                .map(|s| Strict {
                    gauge: s.gauge.clone(),
                    period: s.spec.period,
                })
                .collect(),
            commands: Vec::new(),
            stale: creature.halt.stale,
            channel: halt.clone(),
            progress: Arc::default(),
            thaw: Thaw::new(period),
        };
        Machine {
            creature,
            page,
            stations,
            hands,
            body: None,
            apart: None,
            taps,
            halt,
            watchdog,
        }
    }

    /// The motor unit that drives `link`, and its counters; from now on the watchdog looks after both.
    fn embody(&mut self, link: MotorEnd) -> (Motor, Arc<BeatGauge>) {
        let creature = &self.creature;
        let body = creature.body.as_ref().expect("the caller looked");
        let kind = body::find(body.declaration.name).expect("a checked body is of a known kind");
        let net = Net::new(creature, &self.page);
        let sensors = body.declaration.outputs.iter().enumerate();
        let sensor = |(i, port): (usize, &ipc::wiring::Port)| self.page.writer(i, port.kind);
        let sensors = sensors.map(sensor).map(|w| w.expect("one writer")).collect();
        let gauges: Vec<_> = self.stations.iter().map(|s| s.gauge.clone()).collect();
        let gauge = Arc::new(BeatGauge::default());
        let passed = |&i: &usize| (link.commands[i].reader(), body.declaration.inputs[i].limits());
        self.watchdog.commands = kind.motion.iter().map(passed).collect();
        // What is passed on is written once a beat; with less patience than two every other look would fail.
        self.watchdog.stale = self.watchdog.stale.max(Span(2 * body.period.0));
        self.watchdog
            .vital
            .push(Vital::new("motor", gauge.clone(), body.period));
        let halt = self.halt.clone();
        let motor = Motor::new(creature, link, sensors, &net, &self.taps, &gauges, halt);
        (motor, gauge)
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
