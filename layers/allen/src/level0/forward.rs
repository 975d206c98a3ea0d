//! `allen.forward`: drives the robot forward for a while; a halt message stops it.
//!
//! ```text
//!          go / drive                  halt, or timer / stop, done
//!  Still ─────────────► Driving ───────────────────────────────────► Still
//! ```
//! A halt message that arrives while it stands is ignored: there is nothing to halt (Brooks 1991 §6.2).
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

const GO: In<f64> = In::at(0);
const HALT: In<Pulse> = In::at(1);
const SPEED: Out<f64> = Out::at(0);
const DONE: Out<Pulse> = Out::at(1);

/// The kind `allen.forward`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Forward::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.forward",
    about: "drives forward for a while when told to go; stops on halt",
    diagram: "Still --go--> Driving --halt or timer/done--> Still",
    inputs: &[
        Port::new("go", Kind::Number, "strength of the impulse to go"),
        Port::new("halt", Kind::Pulse, "something is dead ahead"),
    ],
    outputs: &[
        Port::new("speed", Kind::Number, "forward speed, every beat").unit("m/s"),
        Port::new("done", Kind::Pulse, "the drive is over"),
    ],
    parameters: &[
        Parameter::number("speed", 0.3, "how fast to drive")
            .between(0.0, 10.0)
            .unit("m/s"),
        Parameter::span("drive", Span::secs(3), "how long one impulse drives"),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Still,
    Driving { until: Time },
}

struct Forward {
    state: State,
    speed: f64,
    drive: Span,
}

impl Forward {
    fn new(settings: &Settings<'_>) -> Forward {
        Forward {
            state: State::Still,
            speed: settings.number("speed"),
            drive: settings.span("drive"),
        }
    }
}

impl Module for Forward {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let mut speed = 0.0;
        match self.state {
            State::Still => {
                if beat.arrived(GO).is_some() {
                    self.state = State::Driving {
                        until: now + self.drive,
                    };
                }
            }
            State::Driving { until } => {
                if beat.arrived(HALT).is_some() || now >= until {
                    beat.emit(DONE, Pulse);
                    self.state = State::Still;
                } else {
                    speed = self.speed;
                }
            }
        }
        beat.emit(SPEED, speed);
    }

    fn reset(&mut self) {
        self.state = State::Still;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Still => "still",
            State::Driving { .. } => "driving",
        }
    }
}
