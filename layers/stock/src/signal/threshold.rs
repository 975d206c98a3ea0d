//! `threshold`: whether a number is high, with hysteresis.
//!
//! ```text
//!  Low ──in ≥ level / out := 1──► High           Low ──in < level / out := 0──► Low
//!  High ──in < level - hysteresis / out := 0──► Low           High ──else / out := 1──► High
//! ```
//! Emits a bit for each message, changed or not: `edge` or `change` tells the difference. It begins low.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::declare::{input, needed, out, positive};

const IN: In<f64> = In::at(0);
const OUT: Out<bool> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "threshold",
        about: "true from when a number reaches a level until it falls clearly below it",
        diagram: "Low --in >= level/out := 1--> High --in < level - hysteresis/out := 0--> Low\n\
            a bit for each message, changed or not",
        inputs: &[input(Kind::Number, "any number")],
        outputs: &[out(Kind::Bit, "whether it is high")],
        parameters: &[
            needed("level", "[in]", "from here on it is high"),
            positive(
                "hysteresis",
                0.0,
                "[in]",
                "how far below the level it is still high",
            ),
        ],
    },
    build: |s| Box::new(Threshold::new(s)),
}];

struct Threshold {
    level: f64,
    hysteresis: f64,
    high: bool,
}

impl Threshold {
    fn new(settings: &Settings<'_>) -> Threshold {
        Threshold {
            level: settings.number("level"),
            hysteresis: settings.number("hysteresis"),
            high: false,
        }
    }
}

impl Module for Threshold {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(number) = beat.arrived(IN) else { return };
        let down = if self.high { self.hysteresis } else { 0.0 };
        self.high = number >= self.level - down;
        beat.emit(OUT, self.high);
    }

    fn reset(&mut self) {
        self.high = false;
    }

    fn state(&self) -> &'static str {
        if self.high { "high" } else { "low" }
    }
}
