//! `allen.sonar`: runs the ring of sonars and emits a map of what they heard.
//!
//! ```text
//!            timer                    echo / map
//!  Waiting ─────────► Listening ────────────────► Waiting
//!     ▲   / ping           │ no echo within the period: ping again
//!     └────────────────────┘
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

const ECHO: In<Map> = In::at(0);
const PING: Out<Pulse> = Out::at(0);
const MAP: Out<Map> = Out::at(1);

/// The kind `allen.sonar`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Sonar::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.sonar",
    about: "runs the sonars once a period and emits a map of twelve ranges",
    diagram: "Waiting --timer/ping--> Listening --echo/map--> Waiting",
    inputs: &[Port::new("echo", Kind::Map, "what the ring heard")
        .unit("m")
        .between(0.0, 100.0)],
    outputs: &[
        Port::new("ping", Kind::Pulse, "fires the ring"),
        Port::new("map", Kind::Map, "ranges in polar order, straight ahead first").unit("m"),
    ],
    parameters: &[Parameter::span(
        "every",
        Span::secs(1),
        "time between two pings (Brooks 1991 §6.2: every second)",
    )],
};

#[derive(Clone, Copy)]
enum State {
    Waiting,
    Listening,
}

struct Sonar {
    state: State,
    every: Span,
    next: Time,
}

impl Sonar {
    fn new(settings: &Settings<'_>) -> Sonar {
        Sonar {
            state: State::Waiting,
            every: settings.span("every"),
            next: Time::ZERO,
        }
    }
}

impl Module for Sonar {
    fn step(&mut self, beat: &mut Beat<'_>) {
        match self.state {
            State::Waiting if beat.now() >= self.next => self.ping(beat),
            State::Waiting => {}
            State::Listening => {
                if let Some(map) = beat.arrived(ECHO) {
                    beat.emit(MAP, map);
                    self.state = State::Waiting;
                } else if beat.now() >= self.next {
                    self.ping(beat);
                }
            }
        }
    }

    fn reset(&mut self) {
        self.state = State::Waiting;
        self.next = Time::ZERO;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Waiting => "waiting",
            State::Listening => "listening",
        }
    }
}

impl Sonar {
    fn ping(&mut self, beat: &mut Beat<'_>) {
        beat.emit(PING, Pulse);
        // Pings keep to their grid; a late one does not shift those after it.
        let due = self.next + self.every;
        self.next = if due > beat.now() {
            due
        } else {
            beat.now() + self.every
        };
        self.state = State::Listening;
    }
}
