//! `monoflop`: a bit that a pulse turns on for a while.
//!
//! ```text
//!  Off ──in, written at s / out := 1──► On ──timer s + length / out := 0──► Off
//!                                       │ ▲ in, if `again`: the time begins again
//!                                       └─┘
//! ```
//! Emits when it turns on and when it turns off. A pulse at the very moment of the end keeps it on if `again`, and is
//! ignored if not.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pulse};
use ipc::wiring::{Declaration, Parameter};

use crate::declare::{input, out, span};

const IN: In<Pulse> = In::at(0);
const OUT: Out<bool> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "monoflop",
        about: "a bit that a pulse turns on for a while",
        diagram: "Off --in, written at s/out := 1--> On --timer s + length/out := 0--> Off\n\
            On --in, if again--> On: the time begins again",
        inputs: &[input(Kind::Pulse, "turn on")],
        outputs: &[out(Kind::Bit, "true when it turns on, false when it turns off")],
        parameters: &[
            span("length", "how long it stays on after the pulse was written"),
            Parameter::bit(
                "again",
                true,
                "whether a pulse while it is on begins the time again",
            ),
        ],
    },
    build: |s| {
        Box::new(Monoflop {
            length: s.span("length"),
            again: s.bit("again"),
            until: None,
        })
    },
}];

struct Monoflop {
    length: Span,
    again: bool,
    until: Option<Time>,
}

impl Module for Monoflop {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let pulse = beat.arrived(IN).and(beat.stamp(IN));
        match (self.until, pulse) {
            (None, Some(stamp)) => {
                self.until = Some(stamp + self.length);
                beat.emit(OUT, true);
            }
            (Some(_), Some(stamp)) if self.again => self.until = Some(stamp + self.length),
            (Some(until), _) if until <= beat.now() => {
                self.until = None;
                beat.emit(OUT, false);
            }
            _ => {}
        }
    }

    fn reset(&mut self) {
        self.until = None;
    }

    fn state(&self) -> &'static str {
        if self.until.is_some() { "on" } else { "off" }
    }
}
