//! `@NAME@.sway`: says what it hears, a little more and a little less by turns.
//!
//! ```text
//!  More ──timer / said := heard + by; timer := every──► Less
//!  Less ──timer / said := heard - by; timer := every──► More
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::@TYPES@;
use ipc::wiring::{Declaration, Parameter, Port, Takes};

// Ports by their place in the declaration. A module sees its own and nothing else.
const HEARD: In<@TYPE@> = In::at(0);
const SAID: Out<@TYPE@> = Out::at(0);

/// What the module looks like from outside, and how one is built.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "@NAME@.sway",
        about: "says what it hears, a little more and a little less by turns",
        diagram: "More --timer/said := heard + by--> Less --timer/said := heard - by--> More",
        inputs: &[Port::new("heard", Kind::@KIND@, "what to sway about").unit("@UNIT@")],
        outputs: &[Port::new("said", Kind::@KIND@, "a little beside it").unit("@UNIT@")],
        parameters: &[
            Parameter::span("every", Span::millis(500), "time between two messages"),
            Parameter::number("by", 0.25, "how far it sways").unit("@BY@"),
        ],
    },
    build: |settings| Box::new(Sway::new(settings)),
};

enum State {
    More,
    Less,
}

struct Sway {
    state: State,
    timer: Time,
    every: Span,
    by: f64,
}

impl Sway {
    fn new(settings: &Settings<'_>) -> Sway {
        Sway {
            state: State::More,
            timer: Time::ZERO,
            every: settings.span("every"),
            by: settings.number("by"),
        }
    }
}

impl Module for Sway {
    // One step a beat: no waiting, no allocation, at most one message for each output.
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(heard) = beat.latest(HEARD) else { return };
        if beat.now() < self.timer {
            return;
        }
        self.timer = beat.now() + self.every;
        self.state = match self.state {
            State::More => {
                beat.emit(SAID, @MORE@);
                State::Less
            }
            State::Less => {
                beat.emit(SAID, @LESS@);
                State::More
            }
        };
    }

    fn reset(&mut self) {
        self.state = State::More;
        self.timer = Time::ZERO;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::More => "more",
            State::Less => "less",
        }
    }
}
