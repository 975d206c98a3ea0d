//! A link: commands one way, sensors and a pulse the other, between a motor unit and its world.
//!
//! ```text
//!   motor end                                   world end
//!     commands: writers ──► cells ──► readers, behind the body's own gate
//!     sensors:  readers ◄── cells ◄── writers
//!     pulse:    reader  ◄── cell  ◄── writer    once a turn: "I live", and how the body's gate stands
//! ```
//! The cells lie in plain memory, or in the pages of two processes; then the readers of either end are
//! handed over whenever the other process comes (back).
//!
//! Must never let a motion command through to the world that its gate has not passed.

use std::sync::Arc;

use ipc::body::{PULSE_KIND, Pulse};
use ipc::clock::{Span, Time};
use ipc::message::{WORDS_MAX, Words};
use ipc::wire::{Limits, Page, Reader, Reading, Writer};
use ipc::wiring::{Declaration, Port};

use super::BodyKind;
use super::gate::BodyGate;
use super::handover::{Giver, Taker, handover};
use crate::gate::Causes;

/// What the motor unit reads of the world.
#[derive(Debug)]
pub struct SensorReaders {
    /// One for each output of the body: what the sensors say.
    pub sensors: Vec<Reader>,
    /// That the world lives.
    pub pulse: Reader,
}

/// What the world reads of the motor unit: one for each input of the body.
pub type CommandReaders = Vec<Reader>;

/// The motor unit's end of a link.
#[derive(Debug)]
pub struct MotorEnd {
    /// One for each input of the body: commands to the world.
    pub commands: Vec<Writer>,
    /// What the world says.
    pub readers: SensorReaders,
    /// Where readers of another world process come from.
    pub taker: Taker<SensorReaders>,
}

/// The world's end of a link.
#[derive(Debug)]
pub struct WorldEnd {
    kind: &'static BodyKind,
    limits: Vec<Limits>,
    commands: CommandReaders,
    taker: Taker<CommandReaders>,
    /// The newest message on each command, as of this turn.
    looked: Vec<Option<Reading>>,
    seen: Vec<u64>,
    sensors: Vec<Writer>,
    pulse: Writer,
    gate: BodyGate,
    leaving: Causes,
    now: Time,
}

/// How many cells the world writes: its sensors, and its pulse.
pub fn world_cells(declaration: &Declaration) -> usize {
    declaration.outputs.len() + 1
}

/// Readers of the commands that lie in `page` from cell `first` on; `None` if it has too few cells.
pub fn command_readers(declaration: &Declaration, page: &Arc<Page>, first: usize) -> Option<CommandReaders> {
    let readers = declaration.inputs.iter().enumerate();
    readers.map(|(i, p)| page.reader(first + i, p.kind)).collect()
}

/// Readers of the sensors that lie in `page` from cell `first` on; `None` if it has too few cells.
pub fn sensor_readers(declaration: &Declaration, page: &Arc<Page>, first: usize) -> Option<SensorReaders> {
    let outputs = declaration.outputs;
    let sensors = outputs.iter().enumerate();
    Some(SensorReaders {
        sensors: sensors
            .map(|(i, p)| page.reader(first + i, p.kind))
            .collect::<Option<_>>()?,
        pulse: page.reader(first + outputs.len(), PULSE_KIND)?,
    })
}

fn writers(ports: &[Port], page: &Arc<Page>, first: usize) -> Vec<Writer> {
    let writer = |(i, p): (usize, &Port)| page.writer(first + i, p.kind);
    let writers = ports.iter().enumerate().map(writer);
    writers.map(|w| w.expect("a wire has one writer")).collect()
}

/// A motor unit's end without a world yet: its commands are the cells of `page` from `first` on, and a world
/// may be handed over at any time.
pub fn motor_end(
    declaration: &'static Declaration,
    page: &Arc<Page>,
    first: usize,
) -> (MotorEnd, Giver<SensorReaders>) {
    let (giver, taker) = handover();
    let nothing = Page::in_memory(world_cells(declaration));
    let end = MotorEnd {
        commands: writers(declaration.inputs, page, first),
        readers: sensor_readers(declaration, &nothing, 0).expect("the page was made for them"),
        taker,
    };
    (end, giver)
}

/// A world's end without a motor unit yet: its sensors are the first cells of `page`, and a motor unit may be
/// handed over at any time.
pub fn world_end(kind: &'static BodyKind, page: &Arc<Page>) -> (WorldEnd, Giver<CommandReaders>) {
    let declaration = kind.declaration;
    let (giver, taker) = handover();
    let nothing = Page::in_memory(declaration.inputs.len());
    let inputs = declaration.inputs;
    let end = WorldEnd {
        kind,
        limits: inputs.iter().map(Port::limits).collect(),
        commands: command_readers(declaration, &nothing, 0).expect("the page was made for them"),
        taker,
        looked: vec![None; inputs.len()],
        seen: vec![0; inputs.len()],
        sensors: writers(declaration.outputs, page, 0),
        pulse: page
            .writer(declaration.outputs.len(), PULSE_KIND)
            .expect("a wire has one writer"),
        gate: BodyGate::new(kind.stale),
        leaving: Causes::NONE,
        now: Time::ZERO,
    };
    (end, giver)
}

/// A link between a motor unit and its world, in plain memory.
pub fn link(kind: &'static BodyKind) -> (MotorEnd, WorldEnd) {
    let declaration = kind.declaration;
    let commands = Page::in_memory(declaration.inputs.len());
    let said = Page::in_memory(world_cells(declaration));
    let (mut motor, _) = motor_end(declaration, &commands, 0);
    let (mut world, _) = world_end(kind, &said);
    motor.readers = sensor_readers(declaration, &said, 0).expect("the page was made for them");
    world.commands = command_readers(declaration, &commands, 0).expect("the page was made for them");
    (motor, world)
}

impl WorldEnd {
    /// Begins a turn: looks at every command, then at the clock, and lets the gate decide.
    pub fn begin(&mut self, clock: impl FnOnce() -> Time) -> Time {
        if self.taker.take(&mut self.commands) {
            // Another page: its messages count from the beginning.
            self.seen.fill(0);
            self.looked.fill(None);
        }
        for (looked, command) in self.looked.iter_mut().zip(&self.commands) {
            // A read that found no whole message keeps the old one, whose age tells.
            *looked = command.read().or(*looked);
        }
        self.now = clock();
        let motion = self.kind.motion.iter();
        let commands = motion.map(|&i| (self.looked[i].as_ref(), &self.limits[i]));
        self.gate.decide(self.now, commands, self.leaving);
        self.now
    }

    /// Ends a turn: shows that the world lives, and how its gate stands.
    pub fn end(&mut self) {
        let pulse = Pulse {
            causes: self.gate.causes().0 as u32,
            closings: self.gate.closings(),
        };
        self.pulse.write(self.now, &pulse.pack());
    }

    /// What motion input `index` of the declaration says; all zeros while the gate is closed.
    pub fn motion(&self, index: usize) -> Words {
        assert!(self.kind.motion.contains(&index), "input {index} moves nothing");
        match self.looked[index] {
            Some(reading) if self.gate.causes() == Causes::NONE => reading.words,
            _ => [0.0; WORDS_MAX],
        }
    }

    /// A new message on input `index`, one that moves nothing, if there is one. Stale ones and what is no
    /// message are passed over.
    pub fn order(&mut self, index: usize) -> Option<Words> {
        let reading = self.looked[index].filter(|r| r.number != self.seen[index])?;
        self.seen[index] = reading.number;
        let fresh = reading.stamp <= self.now && self.now.since(reading.stamp) <= self.kind.stale;
        let limits = &self.limits[index];
        let sound = limits.kind.accepts(&reading.words, limits.low, limits.high);
        (fresh && sound).then_some(reading.words)
    }

    /// Says what sensor `index` of the declaration measured at `stamp`.
    pub fn tell(&mut self, index: usize, stamp: Time, words: &Words) {
        self.sensors[index].write(stamp, words);
    }

    /// Why the body's own gate is closed; nothing when it is open.
    pub fn causes(&self) -> Causes {
        self.gate.causes()
    }

    /// Closes the gate for good: the process is leaving, or cannot be trusted any more.
    pub fn close(&mut self, cause: Causes) {
        self.leaving = self.leaving.with(cause);
    }

    /// How old a command may be.
    pub fn stale(&self) -> Span {
        self.kind.stale
    }
}
