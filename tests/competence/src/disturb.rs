//! Layers gone wrong: modules that flood the wires they may tap.
//!
//! Must never be part of a creature that anybody ships.

use afsm::random::Random;
use afsm::{Beat, Module, ModuleKind, Out, Settings};
use core::f64::consts::PI;
use ipc::message::{Kind, Polar};
use ipc::wiring::{Declaration, Port};

const HEADING: Out<Polar> = Out::at(0);
const OUTPUTS: &[Port] = &[Port::new("heading", Kind::Polar, "anything")];

/// The kind `trial.nonsense`: no message of it is one.
pub static NONSENSE: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "trial.nonsense",
        about: "writes what is not a number or out of range, every beat",
        diagram: "Flooding --beat/heading := nonsense--> Flooding",
        inputs: &[],
        outputs: OUTPUTS,
        parameters: &[],
    },
    build: |s| Box::new(Flood::new(s, false)),
};

/// The kind `trial.chatter`: random headings.
pub static CHATTER: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "trial.chatter",
        about: "writes a random heading, every beat",
        diagram: "Flooding --beat/heading := random--> Flooding",
        inputs: &[],
        outputs: OUTPUTS,
        parameters: &[],
    },
    build: |s| Box::new(Flood::new(s, true)),
};

/// What no port may take.
const NO_MESSAGE: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];

struct Flood {
    random: Random,
    valid: bool,
}

impl Flood {
    fn new(settings: &Settings<'_>, valid: bool) -> Flood {
        Flood {
            random: Random::new(settings.seed()),
            valid,
        }
    }
}

impl Module for Flood {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let bearing = if self.valid {
            self.random.between(-PI, PI)
        } else {
            NO_MESSAGE[self.random.between(0.0, NO_MESSAGE.len() as f64) as usize]
        };
        beat.emit(HEADING, Polar { length: 5.0, bearing });
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "flooding"
    }
}
