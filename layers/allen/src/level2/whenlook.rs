//! `allen.whenlook`: notices that the robot is not busy moving, and has the free-space finder look.
//!
//! ```text
//!            moving, or pathplan pursues a place
//!      ┌──────────────────────────────┐
//!      ▼                              │
//!  Watching ──nothing moved for `rest` / look, hold──► Looking ──time: back──► Watching
//!                                       └─ every beat: hold ─┘
//! ```
//! While it looks it holds wandering, so that what is seen stays true (Brooks 1991 §6.2). When nothing worth
//! going to was seen it lets the robot wander and looks again after `again`.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

const SPEED: In<f64> = In::at(0);
const RATE: In<f64> = In::at(1);
const PURSUING: In<bool> = In::at(2);
const LOOK: Out<Pulse> = Out::at(0);
const HOLD: Out<Pulse> = Out::at(1);

/// Slower than this the robot is not moving, m/s and rad/s: commands are nought or well above it.
const STILL: f64 = 0.02;

/// The kind `allen.whenlook`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(WhenLook::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.whenlook",
    about: "notices that the robot is not busy, starts the free-space finder and holds wandering meanwhile",
    diagram: "Watching --still for rest/look, hold--> Looking --time--> Watching; hold every beat while Looking",
    inputs: &[
        Port::new("speed", Kind::Number, "how fast the robot is told to drive").unit("m/s"),
        Port::new("rate", Kind::Number, "how fast the robot is told to turn").unit("rad/s"),
        Port::new("pursuing", Kind::Bit, "whether a place is being made for"),
    ],
    outputs: &[
        Port::new("look", Kind::Pulse, "look for free space now"),
        Port::new("hold", Kind::Pulse, "no wandering: the picture must stay true"),
    ],
    parameters: &[
        Parameter::span("rest", Span::millis(700), "how long nothing may have moved"),
        Parameter::span(
            "looking",
            Span::millis(1300),
            "how long a look takes: three pictures, and the way to pathplan",
        ),
        Parameter::span(
            "again",
            Span::millis(3000),
            "how long after a look that found nothing before the next one",
        ),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Watching { still_since: Time, not_before: Time },
    Looking { until: Time },
}

/// Nothing seen yet.
const BEGIN: State = State::Watching {
    still_since: Time::ZERO,
    not_before: Time::ZERO,
};

struct WhenLook {
    state: State,
    rest: Span,
    looking: Span,
    again: Span,
}

impl WhenLook {
    fn new(settings: &Settings<'_>) -> WhenLook {
        WhenLook {
            state: BEGIN,
            rest: settings.span("rest"),
            looking: settings.span("looking"),
            again: settings.span("again"),
        }
    }
}

impl Module for WhenLook {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let (Some(speed), Some(rate)) = (beat.latest(SPEED), beat.latest(RATE)) else {
            return;
        };
        let moving = speed.abs() > STILL || rate.abs() > STILL;
        let busy = moving || beat.latest(PURSUING).unwrap_or(false);
        match self.state {
            State::Watching {
                still_since,
                not_before,
            } => {
                if busy || still_since == Time::ZERO {
                    self.state = State::Watching {
                        still_since: now,
                        not_before,
                    };
                } else if now >= not_before && now.since(still_since) >= self.rest {
                    beat.emit(LOOK, Pulse);
                    beat.emit(HOLD, Pulse);
                    self.state = State::Looking {
                        until: now + self.looking,
                    };
                }
            }
            State::Looking { until } => {
                if moving || now >= until {
                    self.state = State::Watching {
                        still_since: now,
                        not_before: now + self.again,
                    };
                } else {
                    beat.emit(HOLD, Pulse);
                }
            }
        }
    }

    fn reset(&mut self) {
        self.state = BEGIN;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Watching { .. } => "watching",
            State::Looking { .. } => "looking",
        }
    }
}
