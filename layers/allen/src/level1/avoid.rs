//! `allen.avoid`: sums a heading, as an attraction, with the repulsion the sonars feel.
//!
//! ```text
//!  Free ──goal──► Drawn: on every force, heading := attraction·u(goal) + F
//!    ▲              │ goal older than `patience`
//!    └──────────────┘
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::Span;
use ipc::message::{Kind, Polar, Vector};
use ipc::wiring::{Declaration, Parameter, Port};

const GOAL: In<f64> = In::at(0);
const FORCE: In<Vector> = In::at(1);
const COMPASS: In<f64> = In::at(2);
const HEADING: Out<Polar> = Out::at(0);

/// The kind `allen.avoid`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Avoid::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.avoid",
    about: "sums a heading as an attraction with the repulsive force, near to where it should and clear of things",
    diagram: "Free --goal--> Drawn --force/heading := attraction*unit(goal) + F--> Drawn --goal too old--> Free",
    inputs: &[
        Port::new("goal", Kind::Number, "where to go, by the compass")
            .unit("rad")
            .between(-1e6, 1e6),
        Port::new("force", Kind::Vector, "the repulsion, in the robot's frame").unit("1/m2"),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    ],
    outputs: &[Port::new(
        "heading",
        Kind::Polar,
        "where to, in the robot's frame",
    )],
    parameters: &[
        Parameter::number("attraction", 2.0, "how strongly the heading draws")
            .between(0.0, 1000.0)
            .unit("1/m2"),
        Parameter::span("patience", Span::secs(14), "how long a heading draws"),
    ],
};

struct Avoid {
    attraction: f64,
    patience: Span,
    drawn: bool,
}

impl Avoid {
    fn new(settings: &Settings<'_>) -> Avoid {
        Avoid {
            attraction: settings.number("attraction"),
            patience: settings.span("patience"),
            drawn: false,
        }
    }
}

impl Module for Avoid {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        self.drawn = beat
            .stamp(GOAL)
            .is_some_and(|stamp| now.since(stamp) < self.patience);
        let (true, Some(force)) = (self.drawn, beat.arrived(FORCE)) else {
            return;
        };
        let (Some(goal), Some(compass)) = (beat.latest(GOAL), beat.latest(COMPASS)) else {
            return;
        };
        let x = self.attraction * libm::cos(goal - compass) + force.x;
        let y = self.attraction * libm::sin(goal - compass) + force.y;
        beat.emit(
            HEADING,
            Polar {
                length: libm::hypot(x, y),
                bearing: libm::atan2(y, x),
            },
        );
    }

    fn reset(&mut self) {
        self.drawn = false;
    }

    fn state(&self) -> &'static str {
        if self.drawn { "drawn" } else { "free" }
    }
}
