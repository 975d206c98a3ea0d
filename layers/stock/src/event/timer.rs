//! `timer`: a pulse a while after it was started, unless it is stopped.
//!
//! ```text
//!  Idle ──start, written at s──► Running ──timer s + length / done──► Idle
//!    ▲                            │  ▲ │ start: begins again
//!    └────────────stop────────────┘  └─┘
//! ```
//! What counts is when messages were written: a stop before s + length stops it, one at s + length comes too late.
//! With start and stop at one beat stop wins.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Port};

use crate::declare::span;

const START: In<Pulse> = In::at(0);
const STOP: In<Pulse> = In::at(1);
const DONE: Out<Pulse> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "timer",
        about: "a pulse a while after it was started, unless it is stopped or started again",
        diagram: "Idle --start, written at s--> Running --timer s + length/done--> Idle\n\
            Running --start--> Running: begins again; Running --stop--> Idle; both at one beat: stop wins",
        inputs: &[
            Port::new("start", Kind::Pulse, "begin, or begin again"),
            Port::new("stop", Kind::Pulse, "forget it"),
        ],
        outputs: &[Port::new("done", Kind::Pulse, "the time is over")],
        parameters: &[span("length", "from start to done")],
    },
    build: |s| {
        Box::new(Timer {
            length: s.span("length"),
            until: None,
        })
    },
}];

struct Timer {
    length: Span,
    until: Option<Time>,
}

impl Module for Timer {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let start = beat.arrived(START).and(beat.stamp(START));
        let stop = beat.arrived(STOP).and(beat.stamp(STOP));
        if let Some(until) = self.until {
            let cut_short = [start, stop].into_iter().flatten().any(|stamp| stamp < until);
            if until <= beat.now() && !cut_short {
                beat.emit(DONE, Pulse);
                self.until = None;
            }
        }
        if stop.is_some() {
            self.until = None;
        } else if let Some(stamp) = start {
            self.until = Some(stamp + self.length);
        }
    }

    fn reset(&mut self) {
        self.until = None;
    }

    fn state(&self) -> &'static str {
        if self.until.is_some() { "running" } else { "idle" }
    }
}
