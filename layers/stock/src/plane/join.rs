//! `join.vector`, `join.polar`, `join.pose`: a message from its numbers.
//!
//! ```text
//!  out := (newest x, newest y, …)          emitted when one arrives and all were ever received
//! ```

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Payload, Polar, Pose, Vector, WORDS_MAX};
use ipc::wiring::{Parameter, Port};

use super::split::parts;
use crate::declare::out;
use crate::family::family;

const ABOUT: &str = "puts a message together from numbers";
const DIAGRAM: &str = "out := (newest of each input), when one arrives and all were ever received";

family!(Join: "join.vector" Vector, "join.polar" Polar, "join.pose" Pose);

struct Join<T> {
    whole: bool,
    types: PhantomData<T>,
}

impl<T: Payload> Join<T> {
    const INPUTS: &'static [Port] = parts(T::KIND);
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the message")];
    const PARAMETERS: &'static [Parameter] = &[];
    const OUT: Out<T> = Out::at(0);

    fn new(_: &Settings<'_>) -> Join<T> {
        Join {
            whole: false,
            types: PhantomData,
        }
    }
}

impl<T: Payload + Send> Module for Join<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let mut words = [0.0; WORDS_MAX];
        let mut arrived = false;
        for (index, word) in words[..T::KIND.words()].iter_mut().enumerate() {
            let input = In::<f64>::at(index);
            arrived |= beat.arrived(input).is_some();
            let Some(number) = beat.latest(input) else { return };
            *word = number;
        }
        if arrived {
            self.whole = true;
            beat.emit(Self::OUT, T::unpack(&words));
        }
    }

    fn reset(&mut self) {
        self.whole = false;
    }

    fn state(&self) -> &'static str {
        if self.whole { "whole" } else { "waiting" }
    }
}
