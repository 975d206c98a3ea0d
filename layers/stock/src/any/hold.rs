//! `hold`: sample and hold; the newest message when a pulse asks for it.
//!
//! ```text
//!  Holding ──sample, something was ever received / out := newest in──► Holding
//! ```
//! A message that arrives at the same beat as the pulse is the newest already.

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out};
use crate::family::family;

const ABOUT: &str = "emits the newest message when a pulse asks for it";
const DIAGRAM: &str = "Holding --sample, something was ever received/out := newest in--> Holding";

family!(Hold:
    "hold" f64, "hold.bit" bool, "hold.vector" Vector, "hold.polar" Polar, "hold.map" Map, "hold.pose" Pose,
);

struct Hold<T>(PhantomData<T>);

impl<T: Payload> Hold<T> {
    const INPUTS: &'static [Port] = &[
        input(T::KIND, "what to hold"),
        Port::new("sample", Kind::Pulse, "emit it now"),
    ];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the newest message, for each pulse")];
    const PARAMETERS: &'static [Parameter] = &[];
    const IN: In<T> = In::at(0);
    const SAMPLE: In<Pulse> = In::at(1);

    fn new(_: &Settings<'_>) -> Hold<T> {
        Hold(PhantomData)
    }
}

impl<T: Payload + Send> Module for Hold<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if let (Some(Pulse), Some(message)) = (beat.arrived(Self::SAMPLE), beat.latest(Self::IN)) {
            beat.emit(Out::at(0), message);
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "holding"
    }
}
