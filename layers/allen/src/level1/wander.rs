//! `allen.wander`: a random heading about every ten seconds.
//!
//! ```text
//!  Waiting ──timer / heading := random; timer := every ± jitter──► Waiting
//! ```
use afsm::random::Random;
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::wrap;

const COMPASS: In<f64> = In::at(0);
const HEADING: Out<f64> = Out::at(0);

/// The kind `allen.wander`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Wander::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.wander",
    about: "emits a random heading about every ten seconds",
    diagram: "Waiting --timer/heading := random--> Waiting",
    inputs: &[Port::new("compass", Kind::Number, "which way the robot faces").unit("rad")],
    outputs: &[Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad")],
    parameters: &[
        Parameter::span("every", Span::secs(10), "time between two headings, on average"),
        Parameter::number("jitter", 0.2, "by how much of it the time varies")
            .between(0.0, 0.9)
            .unit("1"),
        Parameter::number(
            "spread",
            core::f64::consts::PI,
            "how far to either side of straight ahead a heading may lie",
        )
        .between(0.0, core::f64::consts::PI)
        .unit("rad"),
    ],
};

struct Wander {
    random: Random,
    seed: u64,
    every: Span,
    jitter: f64,
    spread: f64,
    next: Time,
}

impl Wander {
    fn new(settings: &Settings<'_>) -> Wander {
        Wander {
            random: Random::new(settings.seed()),
            seed: settings.seed(),
            every: settings.span("every"),
            jitter: settings.number("jitter"),
            spread: settings.number("spread"),
            next: Time::ZERO,
        }
    }
}

impl Module for Wander {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(compass) = beat.latest(COMPASS) else {
            return;
        };
        if beat.now() < self.next {
            return;
        }
        let turn = self.random.between(-self.spread, self.spread);
        beat.emit(HEADING, wrap(compass + turn));
        let stretch = 1.0 + self.random.between(-self.jitter, self.jitter);
        let wait = Span::from_seconds(self.every.seconds() * stretch).unwrap_or(self.every);
        self.next = beat.now() + wait;
    }

    fn reset(&mut self) {
        self.random = Random::new(self.seed);
        self.next = Time::ZERO;
    }

    fn state(&self) -> &'static str {
        "waiting"
    }
}
