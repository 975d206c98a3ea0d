//! `random`: random numbers at about even times; `random-heading`: random headings (Brooks 1991 §6.2, wander).
//!
//! ```text
//!  Drawing ──timer / out := random from low up to high; timer := every, ± jitter of it──► Drawing
//! ```
//! The first comes at the first beat. Numbers and times are those of the module's seed, so a run repeats to the bit;
//! the reset line begins the same numbers again.

use afsm::random::Random;
use afsm::{Beat, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter};
use std::f64::consts::PI;

use crate::declare::{number, out};

const OUT: Out<f64> = Out::at(0);
const DIAGRAM: &str = "Drawing --timer/out := random from low up to, not including, high; timer := every, +- jitter of it--> Drawing";
const EVERY: Parameter = Parameter::span("every", Span::secs(10), "time between two numbers, on average");
const JITTER: Parameter = Parameter::number("jitter", 0.0, "by how much of it the time varies")
    .between(0.0, 0.9)
    .unit("1");

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[
    &ModuleKind {
        declaration: &Declaration {
            name: "random",
            about: "emits a random number every so often",
            diagram: DIAGRAM,
            inputs: &[],
            outputs: &[out(Kind::Number, "the number")],
            parameters: &[
                EVERY,
                JITTER,
                number("low", 0.0, "", "smallest number"),
                number("high", 1.0, "", "no number is as large as this"),
            ],
        },
        build: |s| Box::new(Drawing::new(s)),
    },
    &ModuleKind {
        declaration: &Declaration {
            name: "random-heading",
            about: "emits a random heading every so often",
            diagram: DIAGRAM,
            inputs: &[],
            outputs: &[out(Kind::Number, "the heading").unit("rad")],
            parameters: &[
                EVERY,
                JITTER,
                Parameter::number("low", -PI, "rightmost heading")
                    .between(-PI, PI)
                    .unit("rad"),
                Parameter::number("high", PI, "leftmost heading, not reached")
                    .between(-PI, PI)
                    .unit("rad"),
            ],
        },
        build: |s| Box::new(Drawing::new(s)),
    },
];

struct Drawing {
    seed: u64,
    every: Span,
    jitter: f64,
    low: f64,
    high: f64,
    random: Random,
    /// When the next number is due; at the first beat if unknown.
    next: Option<Time>,
}

impl Drawing {
    fn new(settings: &Settings<'_>) -> Drawing {
        Drawing {
            seed: settings.seed(),
            every: settings.span("every"),
            jitter: settings.number("jitter"),
            low: settings.number("low"),
            high: settings.number("high"),
            random: Random::new(settings.seed()),
            next: None,
        }
    }
}

impl Module for Drawing {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let due = self.next.unwrap_or(now);
        if now < due {
            return;
        }
        beat.emit(OUT, self.random.between(self.low, self.high));
        let stretch = 1.0 + self.random.between(-self.jitter, self.jitter);
        let wait = Span::from_seconds(self.every.seconds() * stretch).unwrap_or(self.every);
        self.next = Some((due + wait).max(now));
    }

    fn reset(&mut self) {
        self.random = Random::new(self.seed);
        self.next = None;
    }

    fn state(&self) -> &'static str {
        "drawing"
    }
}
