//! `toggle`: a bit that turns over at every pulse.
//!
//! ```text
//!  Off ──in / out := 1──► On ──in / out := 0──► Off
//! ```
//! It begins as `start` and says so only when the first pulse has turned it.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter};

use crate::declare::{input, out};

const IN: In<Pulse> = In::at(0);
const OUT: Out<bool> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "toggle",
        about: "a bit that turns over at every pulse",
        diagram: "Off --in/out := 1--> On --in/out := 0--> Off",
        inputs: &[input(Kind::Pulse, "turn over")],
        outputs: &[out(Kind::Bit, "what it turned to")],
        parameters: &[Parameter::bit(
            "start",
            false,
            "what it is before the first pulse",
        )],
    },
    build: |s| {
        let start = s.bit("start");
        Box::new(Toggle { start, on: start })
    },
}];

struct Toggle {
    start: bool,
    on: bool,
}

impl Module for Toggle {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if beat.arrived(IN).is_some() {
            self.on = !self.on;
            beat.emit(OUT, self.on);
        }
    }

    fn reset(&mut self) {
        self.on = self.start;
    }

    fn state(&self) -> &'static str {
        if self.on { "on" } else { "off" }
    }
}
