//! `pulse`: a pulse for each message.
//!
//! ```text
//!  Listening ──in (of a bit: only true) / out──► Listening
//! ```
//! Joins a wire of any type to an input that takes pulses.

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out};
use crate::family::family;

const ABOUT: &str = "emits a pulse for each message; of bits, for each that is true";
const DIAGRAM: &str = "Listening --in (of a bit: only true)/out--> Listening";

family!(ToPulse:
    "pulse" f64, "pulse.bit" bool, "pulse.vector" Vector, "pulse.polar" Polar,
    "pulse.map" Map, "pulse.pose" Pose,
);

struct ToPulse<T>(PhantomData<T>);

impl<T: Payload> ToPulse<T> {
    const INPUTS: &'static [Port] = &[input(T::KIND, "any message")];
    const OUTPUTS: &'static [Port] = &[out(Kind::Pulse, "one for each message")];
    const PARAMETERS: &'static [Parameter] = &[];
    const IN: In<T> = In::at(0);

    fn new(_: &Settings<'_>) -> ToPulse<T> {
        ToPulse(PhantomData)
    }
}

impl<T: Payload + Send> Module for ToPulse<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let counts = |message: T| T::KIND != Kind::Bit || bool::unpack(&message.pack());
        if beat.arrived(Self::IN).is_some_and(counts) {
            beat.emit(Out::at(0), Pulse);
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "listening"
    }
}
