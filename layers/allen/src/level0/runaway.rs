//! `allen.runaway`: lets a force through when it is strong enough to run from.
//!
//! ```text
//!  |F| > threshold:  heading := (|F|, direction of F)
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::{Kind, Polar, Vector};
use ipc::wiring::{Declaration, Parameter, Port};

const FORCE: In<Vector> = In::at(0);
const HEADING: Out<Polar> = Out::at(0);

/// The kind `allen.runaway`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(RunAway::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.runaway",
    about: "passes a repulsive force on as a heading when it exceeds a threshold",
    diagram: "|F| > threshold: heading := (|F|, direction of F)",
    inputs: &[Port::new("force", Kind::Vector, "the force, in the robot's frame").unit("1/m2")],
    outputs: &[Port::new(
        "heading",
        Kind::Polar,
        "where to, in the robot's frame",
    )],
    parameters: &[
        Parameter::number("threshold", 1.2, "weaker forces are left alone")
            .between(0.0, 1000.0)
            .unit("1/m2"),
    ],
};

struct RunAway {
    threshold: f64,
}

impl RunAway {
    fn new(settings: &Settings<'_>) -> RunAway {
        RunAway {
            threshold: settings.number("threshold"),
        }
    }
}

impl Module for RunAway {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(force) = beat.arrived(FORCE) else { return };
        let length = libm::hypot(force.x, force.y);
        if length > self.threshold {
            beat.emit(
                HEADING,
                Polar {
                    length,
                    bearing: libm::atan2(force.y, force.x),
                },
            );
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "watching"
    }
}
