//! Two messages into one: what sums, comparisons and gates have in common.
//!
//! ```text
//!  Waiting ──a or b arrives, both were ever received / out := f(newest a, newest b)──► Sound
//!                                                                                  └─► Refused: no finite number
//! ```
//! Must never remember anything but how the last computation ended: the registers hold the rest.

use afsm::{Beat, In, Module, Out};
use ipc::message::Payload;
use ipc::wiring::Port;

use crate::answer::Answer;
use crate::declare::out;

/// A module with inputs `a` and `b` of one type and an output `out`.
pub(crate) struct Pair<T, O, F> {
    compute: F,
    answer: Answer,
    types: std::marker::PhantomData<fn(T) -> O>,
}

/// The ports of a pair from `T` and `T` to `O`.
pub(crate) struct PairPorts<T, O>(std::marker::PhantomData<fn(T) -> O>);

impl<T: Payload, O: Payload> PairPorts<T, O> {
    pub(crate) const INPUTS: &'static [Port] = &[
        Port::new("a", T::KIND, "the first"),
        Port::new("b", T::KIND, "the second"),
    ];
    pub(crate) const OUTPUTS: &'static [Port] = &[out(O::KIND, "the result, whenever a or b arrives")];
}

impl<T: Payload, O: Payload, F: Fn(T, T) -> O> Pair<T, O, F> {
    const A: In<T> = In::at(0);
    const B: In<T> = In::at(1);
    const OUT: Out<O> = Out::at(0);

    /// A pair that computes `compute(a, b)`.
    pub(crate) fn new(compute: F) -> Pair<T, O, F> {
        Pair {
            compute,
            answer: Answer::Waiting,
            types: std::marker::PhantomData,
        }
    }
}

impl<T: Payload, O: Payload, F: Fn(T, T) -> O + Send> Module for Pair<T, O, F> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if beat.arrived(Self::A).is_none() && beat.arrived(Self::B).is_none() {
            return;
        }
        let (Some(a), Some(b)) = (beat.latest(Self::A), beat.latest(Self::B)) else {
            return;
        };
        self.answer = Answer::emit(beat, Self::OUT, (self.compute)(a, b));
    }

    fn reset(&mut self) {
        self.answer = Answer::Waiting;
    }

    fn state(&self) -> &'static str {
        self.answer.state()
    }
}

/// Declares `KINDS`: a [`Pair`] for each name, with the types it goes between and what it computes.
macro_rules! pair {
    ($($name:literal $from:ty => $to:ty: $compute:expr),+ $(,)?) => {
        /// The kinds of this file.
        pub const KINDS: &[&afsm::ModuleKind] = &[$(&afsm::ModuleKind {
            declaration: &ipc::wiring::Declaration {
                name: $name,
                about: ABOUT,
                diagram: DIAGRAM,
                inputs: crate::pair::PairPorts::<$from, $to>::INPUTS,
                outputs: crate::pair::PairPorts::<$from, $to>::OUTPUTS,
                parameters: &[],
            },
            build: |_| Box::new(crate::pair::Pair::<$from, $to, _>::new($compute)),
        }),+];
    };
}
pub(crate) use pair;
