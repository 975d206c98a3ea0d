//! `change`: only what differs from what was last let through.
//!
//! ```text
//!  Unsure ──in / out := in──► Sure ──in, some number of it more than `tolerance` off the last out / out := in──► Sure
//! ```
//! A slow creep gets through as well, as it is compared with what was emitted, not with the message before.
//! Bearings are compared as plain numbers.

use afsm::{Beat, In, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Vector, Words};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out, positive};
use crate::family::family;

const ABOUT: &str = "emits a message only when it differs from the last one emitted";
const DIAGRAM: &str = "Unsure --in/out := in--> Sure --in, some number of it more than tolerance off the last out/\
    out := in--> Sure";

family!(Change:
    "change" f64, "change.bit" bool, "change.vector" Vector, "change.polar" Polar, "change.map" Map,
    "change.pose" Pose,
);

struct Change<T> {
    tolerance: f64,
    last: Option<Words>,
    types: std::marker::PhantomData<T>,
}

impl<T: Payload> Change<T> {
    const INPUTS: &'static [Port] = &[input(T::KIND, "messages")];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "those that differ")];
    const PARAMETERS: &'static [Parameter] = match T::KIND {
        Kind::Bit => &[],
        _ => &[positive(
            "tolerance",
            0.0,
            "[in]",
            "what a number may differ by and count as the same",
        )],
    };
    const IN: In<T> = In::at(0);

    fn new(settings: &Settings<'_>) -> Change<T> {
        Change {
            tolerance: match T::KIND {
                Kind::Bit => 0.0,
                _ => settings.number("tolerance"),
            },
            last: None,
            types: std::marker::PhantomData,
        }
    }
}

impl<T: Payload + Send> Module for Change<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(message) = beat.arrived(Self::IN) else {
            return;
        };
        let words = message.pack();
        let differs = |last: &Words| {
            words
                .iter()
                .zip(last)
                .any(|(a, b)| (a - b).abs() > self.tolerance)
        };
        if self.last.as_ref().is_none_or(differs) {
            self.last = Some(words);
            beat.emit(Out::at(0), message);
        }
    }

    fn reset(&mut self) {
        self.last = None;
    }

    fn state(&self) -> &'static str {
        if self.last.is_some() { "sure" } else { "unsure" }
    }
}
