//! `latch`: keeps the first message until it is cleared.
//!
//! ```text
//!  Open ──in / out := in──► Shut: further messages are ignored ──clear──► Open
//! ```
//! With both at one beat it is cleared first: the message of that beat is taken. The reset line clears it too, but
//! the messages of that beat are lost.

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out};
use crate::family::family;

const ABOUT: &str = "passes the first message on and ignores all others until cleared";
const DIAGRAM: &str = "Open --in/out := in--> Shut --clear--> Open; both at one beat: clear comes first";

family!(Latch:
    "latch" f64, "latch.bit" bool, "latch.vector" Vector, "latch.polar" Polar, "latch.pulse" Pulse,
    "latch.map" Map, "latch.pose" Pose,
);

struct Latch<T> {
    shut: bool,
    types: PhantomData<T>,
}

impl<T: Payload> Latch<T> {
    const INPUTS: &'static [Port] = &[
        input(T::KIND, "messages"),
        Port::new("clear", Kind::Pulse, "take the next one"),
    ];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the first message, once")];
    const PARAMETERS: &'static [Parameter] = &[];
    const IN: In<T> = In::at(0);
    const CLEAR: In<Pulse> = In::at(1);

    fn new(_: &Settings<'_>) -> Latch<T> {
        Latch {
            shut: false,
            types: PhantomData,
        }
    }
}

impl<T: Payload + Send> Module for Latch<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if beat.arrived(Self::CLEAR).is_some() {
            self.shut = false;
        }
        if !self.shut
            && let Some(message) = beat.arrived(Self::IN)
        {
            self.shut = true;
            beat.emit(Out::at(0), message);
        }
    }

    fn reset(&mut self) {
        self.shut = false;
    }

    fn state(&self) -> &'static str {
        if self.shut { "shut" } else { "open" }
    }
}
