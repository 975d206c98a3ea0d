//! `allen.turn`: orients the robot towards a heading, then sets it going.
//!
//! ```text
//!          heading / target          on target / go           done, or timer
//!  Idle ──────────────────► Turning ────────────────► Going ────────────────► Idle
//!                              │ timer (cannot get there)                       ▲
//!                              └────────────────────────────────────────────────┘
//! ```
//! A heading that arrives while it turns or goes is ignored (Brooks 1991 §6.2).
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Polar, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::wrap;

const HEADING: In<Polar> = In::at(0);
const COMPASS: In<f64> = In::at(1);
const DONE: In<Pulse> = In::at(2);
const RATE: Out<f64> = Out::at(0);
const GO: Out<f64> = Out::at(1);

/// Turning takes at most half a circle at half the rate; whatever lasts longer is not going to end.
const TURN_MAX: Span = Span::secs(8);
/// A drive lasts seconds; if its end is never heard, the machine is not busy for ever.
const GO_MAX: Span = Span::secs(12);
/// Rate per error, 1/s: from 0.5 rad on at full rate.
const GAIN: f64 = 2.5;
/// How near the target heading is near enough, radians.
const NEAR: f64 = 0.08;

/// The kind `allen.turn`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Turn::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.turn",
    about: "turns the robot towards a heading, then tells forward to go",
    diagram: "Idle --heading--> Turning --on target/go--> Going --done--> Idle; busy states ignore headings",
    inputs: &[
        Port::new("heading", Kind::Polar, "where to, in the robot's frame").between(-1e6, 1e6),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
        Port::new("done", Kind::Pulse, "forward has stopped"),
    ],
    outputs: &[
        Port::new("rate", Kind::Number, "turning rate, every beat").unit("rad/s"),
        Port::new("go", Kind::Number, "strength of the heading that was turned to"),
    ],
    parameters: &[Parameter::number("rate", 1.2, "fastest turn")
        .between(0.01, 10.0)
        .unit("rad/s")],
};

#[derive(Clone, Copy)]
enum State {
    Idle,
    Turning { target: f64, strength: f64, until: Time },
    Going { until: Time },
}

struct Turn {
    state: State,
    rate: f64,
}

impl Turn {
    fn new(settings: &Settings<'_>) -> Turn {
        Turn {
            state: State::Idle,
            rate: settings.number("rate"),
        }
    }
}

impl Module for Turn {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let mut rate = 0.0;
        match self.state {
            State::Idle => {
                if let (Some(heading), Some(compass)) = (beat.arrived(HEADING), beat.latest(COMPASS)) {
                    let target = wrap(compass + heading.bearing);
                    self.state = State::Turning {
                        target,
                        strength: heading.length,
                        until: now + TURN_MAX,
                    };
                }
            }
            State::Turning {
                target,
                strength,
                until,
            } => {
                let error = wrap(target - beat.latest(COMPASS).unwrap_or(target));
                if error.abs() < NEAR {
                    beat.emit(GO, strength);
                    self.state = State::Going { until: now + GO_MAX };
                } else if now >= until {
                    self.state = State::Idle;
                } else {
                    rate = (GAIN * error).clamp(-self.rate, self.rate);
                }
            }
            State::Going { until } => {
                if beat.arrived(DONE).is_some() || now >= until {
                    self.state = State::Idle;
                }
            }
        }
        beat.emit(RATE, rate);
    }

    fn reset(&mut self) {
        self.state = State::Idle;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Idle => "idle",
            State::Turning { .. } => "turning",
            State::Going { .. } => "going",
        }
    }
}
