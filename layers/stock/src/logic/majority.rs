//! `majority`: what two of three bits say.
//!
//! ```text
//!  out := (a and b) or (b and c) or (c and a)     emitted when one arrives and all were ever received
//! ```
//! Three sensors for one question: one of them may be wrong.

use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Port};

use crate::answer::Answer;
use crate::declare::out;

const INPUTS: [In<bool>; 3] = [In::at(0), In::at(1), In::at(2)];
const OUT: Out<bool> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "majority",
        about: "what two of three bits say",
        diagram: "out := (a and b) or (b and c) or (c and a), when one arrives and all were ever received",
        inputs: &[
            Port::new("a", Kind::Bit, "the first"),
            Port::new("b", Kind::Bit, "the second"),
            Port::new("c", Kind::Bit, "the third"),
        ],
        outputs: &[out(Kind::Bit, "what at least two of them say")],
        parameters: &[],
    },
    build: |_| Box::new(Majority::default()),
}];

#[derive(Default)]
struct Majority {
    answer: Answer,
}

impl Module for Majority {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if INPUTS.iter().all(|input| beat.arrived(*input).is_none()) {
            return;
        }
        let votes = INPUTS.map(|input| beat.latest(input));
        if votes.iter().all(Option::is_some) {
            let yes = votes.iter().filter(|vote| **vote == Some(true)).count();
            self.answer = Answer::emit(beat, OUT, yes >= 2);
        }
    }

    fn reset(&mut self) {
        self.answer = Answer::Waiting;
    }

    fn state(&self) -> &'static str {
        self.answer.state()
    }
}
