//! `flipflop`: a bit that one pulse sets and another clears.
//!
//! ```text
//!  Off ──set / out := 1──► On ──clear / out := 0──► Off
//! ```
//! Emits for each pulse, changed or not. With both at one beat it is cleared: off is the safe side.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Port};

use crate::declare::out;

const SET: In<Pulse> = In::at(0);
const CLEAR: In<Pulse> = In::at(1);
const OUT: Out<bool> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "flipflop",
        about: "a bit that one pulse sets and another clears",
        diagram: "Off --set/out := 1--> On --clear/out := 0--> Off; both at one beat: clear wins",
        inputs: &[
            Port::new("set", Kind::Pulse, "turn it on"),
            Port::new("clear", Kind::Pulse, "turn it off"),
        ],
        outputs: &[out(Kind::Bit, "whether it is on, for each pulse")],
        parameters: &[],
    },
    build: |_| Box::new(FlipFlop::default()),
}];

#[derive(Default)]
struct FlipFlop {
    on: bool,
}

impl Module for FlipFlop {
    fn step(&mut self, beat: &mut Beat<'_>) {
        match (beat.arrived(SET), beat.arrived(CLEAR)) {
            (_, Some(Pulse)) => self.on = false,
            (Some(Pulse), None) => self.on = true,
            (None, None) => return,
        }
        beat.emit(OUT, self.on);
    }

    fn reset(&mut self) {
        self.on = false;
    }

    fn state(&self) -> &'static str {
        if self.on { "on" } else { "off" }
    }
}
