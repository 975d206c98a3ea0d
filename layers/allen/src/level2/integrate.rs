//! `allen.integrate`: how far the robot really came since a place was set out for.
//!
//! ```text
//!  Idle ──start / from := pose──► Integrating ──every / travelled := pose - from──► Integrating
//! ```
//! It does not know where the robot was to go: it monitors the actual path, whoever steers (Brooks 1991
//! §6.2). A new start begins anew.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pose, Pulse, Vector};
use ipc::wiring::{Declaration, Parameter, Port};

const START: In<Pulse> = In::at(0);
const POSE: In<Pose> = In::at(1);
const TRAVELLED: Out<Vector> = Out::at(0);

/// The kind `allen.integrate`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Integrate::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.integrate",
    about: "monitors the path that the robot actually takes since it was told to start",
    diagram: "Idle --start/from := pose--> Integrating --every/travelled := pose - from--> Integrating",
    inputs: &[
        Port::new("start", Kind::Pulse, "measure from here"),
        Port::new("pose", Kind::Pose, "where the wheels think they are"),
    ],
    outputs: &[Port::new(
        "travelled",
        Kind::Vector,
        "the way since the start, by the compass",
    )
    .unit("m")],
    parameters: &[Parameter::span(
        "every",
        Span::millis(250),
        "time between two reports: at full speed eight centimetres",
    )],
};

#[derive(Clone, Copy)]
enum State {
    Idle,
    Integrating { from: Pose, next: Time },
}

struct Integrate {
    state: State,
    every: Span,
}

impl Integrate {
    fn new(settings: &Settings<'_>) -> Integrate {
        Integrate {
            state: State::Idle,
            every: settings.span("every"),
        }
    }
}

impl Module for Integrate {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(pose) = beat.latest(POSE) else { return };
        let now = beat.now();
        if beat.arrived(START).is_some() {
            self.state = State::Integrating {
                from: pose,
                next: now,
            };
        }
        if let State::Integrating { from, next } = self.state
            && now >= next
        {
            let (x, y) = (pose.x - from.x, pose.y - from.y);
            beat.emit(TRAVELLED, Vector { x, y });
            self.state = State::Integrating {
                from,
                next: now + self.every,
            };
        }
    }

    fn reset(&mut self) {
        self.state = State::Idle;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Idle => "idle",
            State::Integrating { .. } => "integrating",
        }
    }
}
