//! The motor unit: the only writer to the body, and the keeper of the halt gate.
//!
//! ```text
//!   command wires ─► registers ─► limits ─► gate ─► link to the world
//!   sensor wires  ◄──────────────────────────────── link to the world
//!                      ▲ reflexes, beats of vital layers, emergency stop (a channel of its own)
//! ```
//! Must never allocate, lock or wait in a beat; nothing a tap does reaches the gate's own inputs.

use std::sync::Arc;

use afsm::assemble::{FiledTap, Wires, join};
use afsm::trace::Tracer;
use ipc::clock::{Span, Time};
use ipc::message::{WORDS_MAX, Words};
use ipc::wire::{AHEAD_MAX, Reader, Register, Writer};
use ipc::wiring::Declaration;
use ipc::wiring::creature::{BODY, Creature, How, PortName};

use crate::body::{self, BodyKind, MotorEnd};
use crate::executor::gauge::BeatGauge;
use crate::gate::{Causes, Gate, Passage, Seen};
use crate::halt::HaltChannel;
use crate::newest::Newest;
use crate::panicked;
use crate::segment;
use crate::watchdog::{Thaw, Vital};

/// The motor unit.
#[derive(Debug)]
pub struct Motor {
    kind: &'static BodyKind,
    registers: Vec<Register>,
    /// The motion inputs that a wire or a tap leads to: the others say nothing ever, and stand still.
    driven: Vec<usize>,
    faults: u64,
    link: MotorEnd,
    sensors: Vec<Sensor>,
    passed: Vec<Words>,
    /// When the world last said that it lives.
    pulse: Newest,
    reflexes: Vec<(Reader, Newest)>,
    vital: Vec<Arc<BeatGauge>>,
    watchdog: Vital,
    thaw: Thaw,
    gate: Gate,
    channel: Arc<HaltChannel>,
    resets: u64,
    period: Span,
    tracer: Option<Tracer>,
}

/// A sensor's wire.
#[derive(Debug)]
struct Sensor {
    wire: Writer,
    /// Number of the newest message of the link that was seen.
    seen: u64,
    /// How many messages were written.
    written: u64,
}

impl Sensor {
    fn new(wire: Writer) -> Sensor {
        Sensor {
            wire,
            seen: 0,
            written: 0,
        }
    }

    fn write(&mut self, now: Time, words: &Words) {
        self.wire.write(now, words);
        self.written += 1;
    }
}

impl Motor {
    /// The motor unit of a checked creature with a body. `sensors` are the wires of the body's outputs.
    ///
    /// # Panics
    /// When the creature was not checked against this kind of body.
    pub fn new(
        creature: &Creature,
        link: MotorEnd,
        sensors: Vec<Writer>,
        wires: &dyn Wires,
        taps: &[FiledTap],
        gauges: &[Arc<BeatGauge>],
        channel: Arc<HaltChannel>,
    ) -> Motor {
        let body = creature
            .body
            .as_ref()
            .expect("a creature with a motor unit has a body");
        let kind = body::find(body.declaration.name).expect("a checked body is of a known kind");
        let inputs = kind.declaration.inputs;
        let (mut registers, mut driven) = (Vec::new(), Vec::new());
        for (index, port) in inputs.iter().enumerate() {
            let name = PortName {
                module: BODY.into(),
                port: port.name.into(),
            };
            let wire = creature
                .layers
                .iter()
                .flat_map(|l| &l.wires)
                .find(|w| w.to == name);
            let reader = wire.map(|w| wires.reader(&w.from).expect("a checked wire has a writer"));
            let wired = reader.is_some();
            let mut register = Register::new(port.limits(), reader);
            let tapped = join(taps, How::Suppress, &name, wires, |end| register.suppress(end));
            registers.push(register);
            if kind.motion.contains(&index) && (wired || tapped) {
                driven.push(index);
            }
        }
        let vital = creature
            .layers
            .iter()
            .zip(gauges)
            .filter(|(layer, _)| layer.vital);
        Motor {
            kind,
            registers,
            driven,
            faults: 0,
            link,
            sensors: sensors.into_iter().map(Sensor::new).collect(),
            passed: vec![[0.0; WORDS_MAX]; inputs.len()],
            pulse: Newest::default(),
            reflexes: creature
                .halt
                .reflexes
                .iter()
                .map(|r| (wires.reader(r).expect("checked"), Newest::default()))
                .collect(),
            vital: vital.map(|(_, gauge)| gauge.clone()).collect(),
            watchdog: Vital::new("watchdog", channel.watchdog.clone(), body.period),
            thaw: Thaw::new(body.period),
            gate: Gate::new(creature.halt.stale, creature.halt.hold),
            channel,
            resets: 0,
            period: body.period,
            tracer: None,
        }
    }

    /// Time between two beats.
    pub fn period(&self) -> Span {
        self.period
    }

    /// Traces every beat from now on.
    pub fn trace(&mut self, tracer: Tracer) {
        self.tracer = Some(tracer);
    }

    /// How many inputs and outputs the body has.
    pub fn ports(&self) -> (usize, usize) {
        (self.registers.len(), self.sensors.len())
    }

    /// First half of a beat: looks at every command.
    pub fn gather(&mut self, now: Time) {
        if let Some(tracer) = &mut self.tracer {
            tracer.begin(now);
        }
        if self.link.taker.take(&mut self.link.readers) {
            // Another world: what it says counts from the beginning.
            self.sensors.iter_mut().for_each(|sensor| sensor.seen = 0);
            self.pulse.forget();
        }
        for register in &mut self.registers {
            // Taps of the creature file never leave, so there is none to give back.
            register.gather(now, std::mem::forget);
        }
        if let Some(tracer) = &mut self.tracer {
            for (slot, register) in self.registers.iter().enumerate() {
                tracer.register(slot, register);
            }
        }
    }

    /// Looks at every command between two beats; see [`Register::look`].
    pub fn look(&mut self, now: Time) {
        if let Some(tracer) = &mut self.tracer {
            tracer.forget();
        }
        for register in &mut self.registers {
            register.look(now, std::mem::forget);
        }
    }

    /// Writes a message on the wire of the `index`-th sensor at once, as though the world had sent it.
    pub fn put(&mut self, index: usize, now: Time, words: &Words) {
        if let Some(tracer) = &mut self.tracer {
            tracer.forget();
        }
        self.sensors[index].write(now, words);
    }

    /// The register behind the `index`-th command; `None` for the reset line, which a body has not.
    pub fn register(&self, index: usize) -> Option<&Register> {
        self.registers.get(index)
    }

    /// What the body looks like from outside.
    pub fn declaration(&self) -> &'static Declaration {
        self.kind.declaration
    }

    /// Second half of a beat: decides, moves the body, passes on what the sensors say.
    pub fn act(&mut self, now: Time) {
        let seen = self.see(now);
        let (causes, passage) = self.gate.decide(&seen);
        self.channel.show(causes, now);
        if let Some(tracer) = &mut self.tracer {
            tracer.causes(causes.0);
        }
        for (index, register) in self.registers.iter().enumerate() {
            let motion = self.kind.motion.contains(&index);
            let words = match register.held() {
                Some((_, words)) if motion => gated(self.kind, index, words, passage),
                Some((_, words)) if register.arrived() => words,
                _ if motion => [0.0; WORDS_MAX],
                _ => continue,
            };
            self.passed[index] = words;
            self.link.commands[index].write(now, &words);
            if let Some(tracer) = &mut self.tracer {
                tracer.passed(index, &words[..self.kind.declaration.inputs[index].kind.words()]);
            }
        }
        let readers = self.link.readers.sensors.iter();
        for (slot, (reader, sensor)) in readers.zip(&mut self.sensors).enumerate() {
            let Some(reading) = reader.newer_than(sensor.seen) else {
                continue;
            };
            sensor.seen = reading.number;
            sensor.write(now, &reading.words);
            if let Some(tracer) = &mut self.tracer {
                tracer.wrote_next(slot, sensor.wire.kind(), &reading.words);
            }
        }
        if let Some(tracer) = &mut self.tracer {
            if tracer.begins_anew() {
                let sensors = self.sensors.iter().map(|s| (s.written, s.wire.kind()));
                tracer.tell_numbers(self.registers.iter().map(Register::seen), sensors);
            }
            tracer.end(now);
        }
    }

    /// What the body is told on input `index`, for tests and watchers.
    pub fn passed(&self, index: usize) -> f64 {
        self.passed[index][0]
    }

    fn see(&mut self, now: Time) -> Seen {
        let stamps = self.driven.iter().map(|&i| self.registers[i].stamp());
        let oldest_command = stamps.min().flatten();
        let faults: u64 = self
            .kind
            .motion
            .iter()
            .map(|&i| self.registers[i].counts().faults)
            .sum();
        let unsound = faults != self.faults;
        self.faults = faults;
        let began = |gauge: &BeatGauge| gauge.counts().beats > 0;
        let vital_began = self.vital.iter().all(|v| began(v)) && began(&self.watchdog.gauge);
        let standing = self.standing(now);
        Seen {
            now,
            oldest_command,
            unsound,
            reflex: self
                .reflexes
                .iter_mut()
                .filter_map(|(wire, newest)| newest.look(wire))
                .map(|stamp| stamp.min(now))
                .max(),
            vital_began,
            standing,
            latched: self.channel.latched(),
            reset: self.channel.reset_asked(&mut self.resets),
        }
    }

    /// Causes that stand now: what the watchdog sees, and what can be seen from here alone.
    fn standing(&mut self, now: Time) -> Causes {
        let mut standing = self.channel.watched();
        let thawed = self.thaw.at(now);
        if self.watchdog.is_late(now, thawed) {
            standing = standing.with(Causes::WATCHDOG);
        }
        // A pulse from the future is no pulse: its writer's clock, or the cell, is wrong.
        let pulse = self.pulse.look(&self.link.readers.pulse);
        let lives = |stamp: Time| stamp <= now + AHEAD_MAX && now.since(stamp) <= self.kind.stale;
        if !pulse.is_some_and(lives) {
            standing = standing.with(Causes::BODY);
        }
        if segment::cut() > 0 {
            standing = standing.with(Causes::MEMORY);
        }
        if panicked::any() {
            standing = standing.with(Causes::PANIC);
        }
        standing
    }
}

/// What of a command to input `index` of a body of this kind gets through the gate.
pub fn gated(kind: &BodyKind, index: usize, mut words: Words, passage: Passage) -> Words {
    match passage {
        Passage::Open => words,
        Passage::NoForward if kind.forward == Some(index) => {
            words[0] = words[0].min(0.0);
            words
        }
        Passage::NoForward => words,
        Passage::Closed => [0.0; WORDS_MAX],
    }
}
