//! `edge`: a pulse when a bit turns true, another when it turns false.
//!
//! ```text
//!  Low ──in = 1 / rising──► High ──in = 0 / falling──► Low
//! ```
//! Before the first message the bit counts as `start`.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::declare::input;

const IN: In<bool> = In::at(0);
const RISING: Out<Pulse> = Out::at(0);
const FALLING: Out<Pulse> = Out::at(1);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "edge",
        about: "a pulse when a bit turns true, another when it turns false",
        diagram: "Low --in = 1/rising--> High --in = 0/falling--> Low",
        inputs: &[input(Kind::Bit, "the bit")],
        outputs: &[
            Port::new("rising", Kind::Pulse, "it turned true"),
            Port::new("falling", Kind::Pulse, "it turned false"),
        ],
        parameters: &[Parameter::bit(
            "start",
            false,
            "what it counts as before the first message",
        )],
    },
    build: |s| {
        let start = s.bit("start");
        Box::new(Edge { start, high: start })
    },
}];

struct Edge {
    start: bool,
    high: bool,
}

impl Module for Edge {
    fn step(&mut self, beat: &mut Beat<'_>) {
        match (self.high, beat.arrived(IN)) {
            (false, Some(true)) => {
                self.high = true;
                beat.emit(RISING, Pulse);
            }
            (true, Some(false)) => {
                self.high = false;
                beat.emit(FALLING, Pulse);
            }
            _ => {}
        }
    }

    fn reset(&mut self) {
        self.high = self.start;
    }

    fn state(&self) -> &'static str {
        if self.high { "high" } else { "low" }
    }
}
