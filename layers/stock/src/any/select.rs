//! `select`: one of two wires, as a bit says.
//!
//! ```text
//!  which = 0: out := newest no          emitted when `which` arrives, or the chosen input
//!  which = 1: out := newest yes
//! ```
//! Nothing is emitted before `which` and the chosen input were both received; the other one is ignored.

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::out;
use crate::family::family;

const ABOUT: &str = "passes one of two wires on, as a bit says";
const DIAGRAM: &str =
    "out := if which { newest yes } else { newest no }, when which or the chosen input arrives";

family!(Select:
    "select" f64, "select.bit" bool, "select.vector" Vector, "select.polar" Polar, "select.map" Map,
    "select.pose" Pose,
);

struct Select<T> {
    which: Option<bool>,
    types: PhantomData<T>,
}

impl<T: Payload> Select<T> {
    const INPUTS: &'static [Port] = &[
        Port::new("which", Kind::Bit, "0 chooses no, 1 chooses yes"),
        Port::new("no", T::KIND, "passed on while which is 0"),
        Port::new("yes", T::KIND, "passed on while which is 1"),
    ];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the chosen one")];
    const PARAMETERS: &'static [Parameter] = &[];
    const WHICH: In<bool> = In::at(0);
    const NO: In<T> = In::at(1);
    const YES: In<T> = In::at(2);

    fn new(_: &Settings<'_>) -> Select<T> {
        Select {
            which: None,
            types: PhantomData,
        }
    }
}

impl<T: Payload + Send> Module for Select<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        self.which = beat.latest(Self::WHICH);
        let Some(which) = self.which else { return };
        let chosen = if which { Self::YES } else { Self::NO };
        if (beat.arrived(Self::WHICH).is_some() || beat.arrived(chosen).is_some())
            && let Some(message) = beat.latest(chosen)
        {
            beat.emit(Out::at(0), message);
        }
    }

    fn reset(&mut self) {
        self.which = None;
    }

    fn state(&self) -> &'static str {
        match self.which {
            None => "waiting",
            Some(false) => "no",
            Some(true) => "yes",
        }
    }
}
