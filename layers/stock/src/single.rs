//! One message into another: what gains, offsets and conversions have in common.
//!
//! ```text
//!  Waiting ──in / out := f(in)──► Sound
//!                             └─► Refused: no finite number
//! ```
//! Must never emit without a message, nor twice for one.

use afsm::{Beat, In, Module, Out};
use ipc::message::Payload;

use crate::answer::Answer;

/// A module with an input `in` and an output `out`.
pub(crate) struct Single<T, O, F> {
    compute: F,
    answer: Answer,
    types: std::marker::PhantomData<fn(T) -> O>,
}

impl<T: Payload, O: Payload, F: Fn(T) -> O> Single<T, O, F> {
    const IN: In<T> = In::at(0);
    const OUT: Out<O> = Out::at(0);

    /// A module that computes `compute(in)`.
    pub(crate) fn new(compute: F) -> Single<T, O, F> {
        Single {
            compute,
            answer: Answer::Waiting,
            types: std::marker::PhantomData,
        }
    }
}

impl<T: Payload, O: Payload, F: Fn(T) -> O + Send> Module for Single<T, O, F> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if let Some(message) = beat.arrived(Self::IN) {
            self.answer = Answer::emit(beat, Self::OUT, (self.compute)(message));
        }
    }

    fn reset(&mut self) {
        self.answer = Answer::Waiting;
    }

    fn state(&self) -> &'static str {
        self.answer.state()
    }
}
