//! `split.vector`, `split.polar`, `split.pose`: the numbers that a message is made of, each on its own wire.
//!
//! ```text
//!  x := in.x, y := in.y, …          emitted together when in arrives
//! ```

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Payload, Polar, Pose, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::input;
use crate::family::family;

const ABOUT: &str = "takes a message apart: each of its numbers on its own wire";
const DIAGRAM: &str = "each output := that number of in, all when in arrives";

family!(Split: "split.vector" Vector, "split.polar" Polar, "split.pose" Pose);

/// The numbers that messages of `kind` are made of, as ports.
pub(super) const fn parts(kind: Kind) -> &'static [Port] {
    match kind {
        Kind::Vector => VECTOR,
        Kind::Polar => POLAR,
        Kind::Pose => POSE,
        _ => panic!("only vectors, polar vectors and poses have parts"),
    }
}

const VECTOR: &[Port] = &[
    Port::new("x", Kind::Number, "forward component"),
    Port::new("y", Kind::Number, "leftward component"),
];
const POLAR: &[Port] = &[
    Port::new("length", Kind::Number, "length"),
    Port::new("bearing", Kind::Number, "bearing, counter-clockwise").unit("rad"),
];
const POSE: &[Port] = &[
    Port::new("x", Kind::Number, "where it is along x").unit("m"),
    Port::new("y", Kind::Number, "where it is along y").unit("m"),
    Port::new("heading", Kind::Number, "which way it faces").unit("rad"),
];

struct Split<T>(PhantomData<T>);

impl<T: Payload> Split<T> {
    const INPUTS: &'static [Port] = &[input(T::KIND, "what to take apart")];
    const OUTPUTS: &'static [Port] = parts(T::KIND);
    const PARAMETERS: &'static [Parameter] = &[];
    const IN: In<T> = In::at(0);

    fn new(_: &Settings<'_>) -> Split<T> {
        Split(PhantomData)
    }
}

impl<T: Payload + Send> Module for Split<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(message) = beat.arrived(Self::IN) else {
            return;
        };
        let words = message.pack();
        for (index, word) in words[..T::KIND.words()].iter().enumerate() {
            beat.emit(Out::at(index), *word);
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "splitting"
    }
}
