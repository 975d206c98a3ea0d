//! `differentiator`: how fast a number changes.
//!
//! ```text
//!  Waiting ──in──► Sound ──in, written dt after the one before / out := (in - before) / dt──► Sound
//! ```
//! In the unit of `in` per second. Two messages written at one moment, or a change too fast to be a number, emit
//! nothing.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::answer::Answer;
use crate::declare::{input, out};

const IN: In<f64> = In::at(0);
const OUT: Out<f64> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "differentiator",
        about: "how fast a number changes, from message to message",
        diagram: "Waiting --in--> Sound --in, written dt after the one before/out := (in - before)/dt, in [in]/s\
            --> Sound",
        inputs: &[input(Kind::Number, "any number")],
        outputs: &[out(
            Kind::Number,
            "its change per second, from the second message on",
        )],
        parameters: &[],
    },
    build: |_| Box::new(Differentiator::default()),
}];

#[derive(Default)]
struct Differentiator {
    before: Option<(Time, f64)>,
    answer: Answer,
}

impl Module for Differentiator {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let (Some(number), Some(stamp)) = (beat.arrived(IN), beat.stamp(IN)) else {
            return;
        };
        if let Some((since, before)) = self.before.replace((stamp, number)) {
            let change = (number - before) / stamp.since(since).seconds();
            self.answer = Answer::emit(beat, OUT, change);
        }
    }

    fn reset(&mut self) {
        *self = Differentiator::default();
    }

    fn state(&self) -> &'static str {
        self.answer.state()
    }
}
