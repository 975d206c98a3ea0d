//! The motor unit: the only writer to the body, and the keeper of the halt gate.
//!
//! ```text
//!   command wires ─► registers ─► limits ─► gate ─► link to the world
//!   sensor wires  ◄──────────────────────────────── link to the world
//!                      ▲ reflexes, beats of vital layers, emergency stop (a channel of its own)
//! ```
//! Must never allocate, lock or wait in a beat; nothing a tap does reaches the gate's own inputs.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use afsm::assemble::{FiledTap, Wires, join};
use afsm::layer::trace_registers;
use afsm::trace::Tracer;
use ipc::clock::{Span, Time};
use ipc::message::{WORDS_MAX, Words};
use ipc::wire::{Reader, Register, Writer};
use ipc::wiring::creature::{BODY, Creature, How, PortName};

use crate::body::{self, BodyKind, MotorEnd};
use crate::executor::gauge::BeatGauge;
use crate::gate::{Causes, Gate, Passage, Seen};

/// The halt channel: how others close the gate, and how all can see whether it is closed.
#[derive(Debug)]
pub struct HaltChannel {
    /// Causes that stand now, latched by others; bits of [`Causes`].
    standing: AtomicU64,
    /// Number of resets asked for.
    resets: AtomicU64,
    /// What the gate decided last; bits of [`Causes`].
    decided: AtomicU64,
    /// When that last changed.
    since: AtomicU64,
    /// How often each cause came up, in the order of its bit.
    counts: [AtomicU64; CAUSES],
}

/// How many causes there are.
const CAUSES: usize = 8;

impl Default for HaltChannel {
    /// Nothing is latched; the gate has not opened yet.
    fn default() -> Self {
        HaltChannel {
            standing: AtomicU64::new(0),
            resets: AtomicU64::new(0),
            decided: AtomicU64::new(Causes::START.0),
            since: AtomicU64::new(0),
            counts: std::array::from_fn(|_| AtomicU64::new(0)),
        }
    }
}

impl HaltChannel {
    /// Closes the gate for `cause`.
    pub fn halt(&self, cause: Causes) {
        // Relaxed: the bit is the message.
        self.standing.fetch_or(cause.0, Ordering::Relaxed);
    }

    /// Ends what is latched.
    ///
    /// # Errors
    /// When the daemon is leaving.
    pub fn reset(&self) -> Result<(), String> {
        let standing = Causes(self.standing.load(Ordering::Relaxed));
        if standing.has(Causes::SHUTDOWN) {
            return Err("the daemon is shutting down; start it again to go on".into());
        }
        self.standing.fetch_and(!standing.0, Ordering::Relaxed);
        self.resets.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    /// How often each cause came up, by its name.
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        Causes::all()
            .zip(&self.counts)
            .map(|((_, name), count)| (name, count.load(Ordering::Relaxed)))
    }

    /// The causes for which the gate is closed, and since when.
    pub fn decided(&self) -> (Causes, Time) {
        (
            Causes(self.decided.load(Ordering::Relaxed)),
            Time(self.since.load(Ordering::Relaxed)),
        )
    }
}

/// A vital layer as the gate watches it.
#[derive(Debug)]
struct Vital {
    gauge: Arc<BeatGauge>,
    /// Later than this after its last beat it is late.
    late: Span,
}

/// The motor unit.
#[derive(Debug)]
pub struct Motor {
    kind: &'static BodyKind,
    registers: Vec<Register>,
    faults: u64,
    sensors: Vec<Sensor>,
    commands: Vec<Writer>,
    passed: Vec<Words>,
    reflexes: Vec<Reader>,
    vital: Vec<Vital>,
    gate: Gate,
    channel: Arc<HaltChannel>,
    resets: u64,
    period: Span,
    causes: Causes,
    tracer: Option<Tracer>,
}

/// A sensor: from the link to its wire.
#[derive(Debug)]
struct Sensor {
    link: Reader,
    seen: u64,
    wire: Writer,
    written: u64,
}

/// Beats that a vital layer may miss before the body halts: one is a hiccup of the host, two are a fault.
const VITAL_BEATS_MAX: u64 = 2;

/// Least lateness that counts, whatever the period: gaps of 10 to 30 ms are a virtual host's own.
const VITAL_LATE_MIN: Span = Span::millis(50);

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
        let mut registers = Vec::new();
        for port in inputs {
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
            let mut register = Register::new(port.limits(), reader);
            join(taps, How::Suppress, &name, wires, |end| register.suppress(end));
            registers.push(register);
        }
        let pairs = link
            .sensors
            .into_iter()
            .zip(sensors)
            .map(|(link, wire)| Sensor {
                link,
                seen: 0,
                wire,
                written: 0,
            })
            .collect();
        let vital = creature
            .layers
            .iter()
            .zip(gauges)
            .filter(|(layer, _)| layer.vital);
        let late = |period: Span| Span((period.0 * (VITAL_BEATS_MAX + 1)).max(VITAL_LATE_MIN.0));
        Motor {
            kind,
            registers,
            faults: 0,
            sensors: pairs,
            commands: link.commands,
            passed: vec![[0.0; WORDS_MAX]; inputs.len()],
            reflexes: creature
                .halt
                .reflexes
                .iter()
                .map(|r| wires.reader(r).expect("checked"))
                .collect(),
            vital: vital
                .map(|(l, gauge)| Vital {
                    gauge: gauge.clone(),
                    late: late(l.period),
                })
                .collect(),
            gate: Gate::new(creature.halt.stale, creature.halt.hold),
            channel,
            resets: 0,
            period: body.period,
            causes: Causes::NONE,
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
        for register in &mut self.registers {
            // Taps of the creature file never leave, so there is none to give back.
            register.gather(now, std::mem::forget);
        }
        if let Some(tracer) = &mut self.tracer {
            trace_registers(tracer, &self.registers);
        }
    }

    /// Second half of a beat: decides, moves the body, passes on what the sensors say.
    pub fn act(&mut self, now: Time) {
        let seen = self.look(now);
        let (causes, passage) = self.gate.decide(&seen);
        self.show(causes, now);
        if let Some(tracer) = &mut self.tracer {
            tracer.causes(causes.0);
        }
        for (index, register) in self.registers.iter().enumerate() {
            let motion = self.kind.motion.contains(&index);
            let words = match register.held() {
                Some((_, words)) if motion => gated(self.kind, index, *words, passage),
                Some((_, words)) if register.arrived() => *words,
                _ if motion => [0.0; WORDS_MAX],
                _ => continue,
            };
            self.passed[index] = words;
            self.commands[index].write(now, &words);
            if let Some(tracer) = &mut self.tracer {
                tracer.passed(index, &words[..self.kind.declaration.inputs[index].kind.words()]);
            }
        }
        for (slot, sensor) in self.sensors.iter_mut().enumerate() {
            let Some(reading) = sensor.link.newer_than(sensor.seen) else {
                continue;
            };
            sensor.seen = reading.number;
            sensor.wire.write(now, &reading.words);
            sensor.written += 1;
            if let Some(tracer) = &mut self.tracer {
                tracer.wrote(slot, sensor.written, &reading.words[..sensor.wire.kind().words()]);
            }
        }
        if let Some(tracer) = &mut self.tracer {
            tracer.end(now);
        }
    }

    /// What the body is told on input `index`, for tests and watchers.
    pub fn passed(&self, index: usize) -> f64 {
        self.passed[index][0]
    }

    fn look(&mut self, now: Time) -> Seen {
        let stamps = self
            .kind
            .motion
            .iter()
            .map(|&i| self.registers[i].held().map(|(stamp, _)| *stamp));
        let oldest_command = stamps.min().flatten();
        let faults: u64 = self
            .kind
            .motion
            .iter()
            .map(|&i| self.registers[i].counts().faults)
            .sum();
        let unsound = faults != self.faults;
        self.faults = faults;
        let began = self.vital.iter().all(|v| v.gauge.counts().beats > 0);
        let late = self
            .vital
            .iter()
            .any(|v| now.since(v.gauge.counts().last) > v.late);
        let resets = self.channel.resets.load(Ordering::Relaxed);
        let reset = resets != self.resets;
        self.resets = resets;
        Seen {
            now,
            oldest_command,
            unsound,
            reflex: self
                .reflexes
                .iter()
                .filter_map(|r| r.read())
                .map(|r| r.stamp.min(now))
                .max(),
            vital_began: began,
            vital_late: late,
            latched: Causes(self.channel.standing.load(Ordering::Relaxed)),
            reset,
        }
    }

    fn show(&mut self, causes: Causes, now: Time) {
        let channel = &self.channel;
        if self.causes != causes || channel.since.load(Ordering::Relaxed) == 0 {
            let new = causes.without(self.causes);
            for ((cause, _), count) in Causes::all().zip(&channel.counts) {
                if new.has(cause) {
                    // Only this thread counts; the numbers are to look at.
                    count.store(count.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
                }
            }
            self.causes = causes;
            channel.decided.store(causes.0, Ordering::Relaxed);
            channel.since.store(now.0.max(1), Ordering::Relaxed);
        }
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
