//! The modules of the lab's creature: messages that carry the moment they were sensed, in nanoseconds.
//!
//! ```text
//!   lab.sense ── now ──► lab.relay ── the same ──► lab.act: age = now − what it hears
//!   lab.voice ── −now ──►(S)                       what came from a tap has its sign turned
//! ```
//! Must never report from a step: ages go into a ring that an ordinary thread empties. A number of nanoseconds
//! fits a message exactly for a hundred days of uptime.

use std::sync::Mutex;

use afsm::{Beat, In, Kinds, Module, ModuleKind, Out, Settings};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Port};
use rtrb::{Consumer, Producer, RingBuffer};

/// What one actuator heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A sensed message this old when the actuator looked at it, in nanoseconds.
    Sensed(u64),
    /// A tap's message, and how long it took to have its effect on the wire, in nanoseconds.
    Tapped(u64),
}

/// Rings of the actuators built in this process, to be emptied by the lab.
static RINGS: Mutex<Vec<Consumer<Heard>>> = Mutex::new(Vec::new());

/// Room for two seconds of an actuator at 2 kHz.
const RING: usize = 4096;

/// Takes in what actuators heard since the last call.
///
/// # Panics
/// Never: nobody panics holding the rings.
pub fn heard(mut each: impl FnMut(Heard)) {
    for ring in RINGS.lock().expect("nobody panics holding the rings").iter_mut() {
        while let Ok(heard) = ring.pop() {
            each(heard);
        }
    }
}

/// The kinds that the lab's creature and its tapper are built with.
pub fn kinds() -> Kinds {
    Kinds::default().with([&SENSE, &VOICE, &RELAY, &ACT])
}

const NOW: Out<f64> = Out::at(0);

/// Says what time it is, every beat, with a sign.
struct Clock(f64);

impl Module for Clock {
    fn step(&mut self, beat: &mut Beat<'_>) {
        beat.emit(NOW, self.0 * beat.now().0 as f64);
    }
    fn reset(&mut self) {}
    fn state(&self) -> &'static str {
        "Telling"
    }
}

static SENSE: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "lab.sense",
        about: "a sensor that senses what time it is",
        diagram: "Telling",
        inputs: &[],
        outputs: &[Port::new("now", Kind::Number, "the moment of the beat").unit("ns")],
        parameters: &[],
    },
    build: |_| Box::new(Clock(1.0)),
};

static VOICE: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "lab.voice",
        about: "the same for a tap, told apart by its sign",
        diagram: "Telling",
        inputs: &[],
        outputs: &[Port::new("now", Kind::Number, "minus the moment of the beat").unit("ns")],
        parameters: &[],
    },
    build: |_| Box::new(Clock(-1.0)),
};

const IN: In<f64> = In::at(0);
const OUT: Out<f64> = Out::at(0);

/// Passes on what it hears.
struct Relay;

impl Module for Relay {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if let Some(heard) = beat.arrived(IN) {
            beat.emit(OUT, heard);
        }
    }
    fn reset(&mut self) {}
    fn state(&self) -> &'static str {
        "Listening"
    }
}

static RELAY: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "lab.relay",
        about: "passes on what it hears",
        diagram: "Listening",
        inputs: &[Port::new("in", Kind::Number, "a moment").unit("ns")],
        outputs: &[Port::new("out", Kind::Number, "the same").unit("ns")],
        parameters: &[],
    },
    build: |_| Box::new(Relay),
};

/// Notes how old what it hears is.
struct Act {
    ring: Producer<Heard>,
}

impl Act {
    fn boxed(_: &Settings<'_>) -> Box<dyn Module> {
        let (ring, out) = RingBuffer::new(RING);
        RINGS.lock().expect("nobody panics holding the rings").push(out);
        Box::new(Act { ring })
    }
}

impl Module for Act {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let (Some(moment), Some(stamp)) = (beat.arrived(IN), beat.stamp(IN)) else {
            return;
        };
        let heard = if moment >= 0.0 {
            Heard::Sensed(beat.now().0.saturating_sub(moment as u64))
        } else {
            Heard::Tapped(stamp.0.saturating_sub((-moment) as u64))
        };
        // A full ring means that nobody looks; then the sample is lost, and the number of samples says so.
        let _ = self.ring.push(heard);
    }
    fn reset(&mut self) {}
    fn state(&self) -> &'static str {
        "Acting"
    }
}

static ACT: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "lab.act",
        about: "an actuator that notes how old its commands are",
        diagram: "Acting",
        inputs: &[Port::new("command", Kind::Number, "the moment it goes back to").unit("ns")],
        outputs: &[],
        parameters: &[],
    },
    build: Act::boxed,
};
