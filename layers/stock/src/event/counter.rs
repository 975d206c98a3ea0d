//! `counter`: counts pulses, up and down, between bounds.
//!
//! ```text
//!  Counting ──up / count + 1──► Counting ──down / count - 1──► Counting          low ≤ count ≤ high
//!           ──up, count becomes high / full──► Full ──down──► Counting
//! ```
//! Emits the count for each pulse, also when a bound kept it as it was. With both at one beat it stays as it is.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

/// Largest count: past it not every whole number is a number of 64 bits.
pub const COUNT_MAX: f64 = 9_007_199_254_740_992.0;

const UP: In<Pulse> = In::at(0);
const DOWN: In<Pulse> = In::at(1);
const COUNT: Out<f64> = Out::at(0);
const FULL: Out<Pulse> = Out::at(1);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "counter",
        about: "counts pulses, up and down",
        diagram: "Counting --up/count + 1--> Counting --down/count - 1--> Counting, low <= count <= high\n\
            Counting --up, count becomes high/full--> Full --down--> Counting",
        inputs: &[
            Port::new("up", Kind::Pulse, "one more"),
            Port::new("down", Kind::Pulse, "one less"),
        ],
        outputs: &[
            Port::new("count", Kind::Number, "the count, for each pulse"),
            Port::new("full", Kind::Pulse, "it has just become high"),
        ],
        parameters: &[
            bound("start", 0.0, "the count before the first pulse"),
            bound("low", 0.0, "smallest count"),
            bound("high", COUNT_MAX, "largest count"),
        ],
    },
    build: |s| Box::new(Counter::new(s)),
}];

const fn bound(name: &'static str, default: f64, about: &'static str) -> Parameter {
    Parameter::number(name, default, about).between(-COUNT_MAX, COUNT_MAX)
}

struct Counter {
    start: f64,
    low: f64,
    high: f64,
    count: f64,
}

impl Counter {
    fn new(settings: &Settings<'_>) -> Counter {
        let start = settings.number("start");
        Counter {
            start,
            low: settings.number("low"),
            high: settings.number("high"),
            count: start,
        }
    }
}

impl Module for Counter {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let before = self.count;
        match (beat.arrived(UP), beat.arrived(DOWN)) {
            (None, None) => return,
            (Some(Pulse), Some(Pulse)) => {}
            // A start outside the bounds may come in, not go farther out.
            (Some(Pulse), None) => self.count = (before + 1.0).min(self.high.max(before)),
            (None, Some(Pulse)) => self.count = (before - 1.0).max(self.low.min(before)),
        }
        beat.emit(COUNT, self.count);
        if before < self.high && self.count >= self.high {
            beat.emit(FULL, Pulse);
        }
    }

    fn reset(&mut self) {
        self.count = self.start;
    }

    fn state(&self) -> &'static str {
        if self.count >= self.high {
            "full"
        } else {
            "counting"
        }
    }
}
