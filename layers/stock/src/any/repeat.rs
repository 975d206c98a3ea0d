//! `repeat`: passes messages on and repeats the newest, so that nobody finds it stale.
//!
//! ```text
//!  Silent ──in / out := in──► Repeating ──timer every / out := in──► Repeating
//!    ▲                            │ no message for `patience`
//!    └────────────────────────────┘
//! ```
//! Must have an end where what it repeats moves a body: without `patience` it speaks for a module that may be dead.

use std::marker::PhantomData;

use afsm::{Beat, In, Module, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out, span, span_or_none};
use crate::family::family;

const ABOUT: &str = "passes messages on and repeats the newest for a while";
const DIAGRAM: &str = "Silent --in/out := in--> Repeating --timer every/out := in--> Repeating\n\
    Repeating --no message for patience--> Silent";

family!(Repeat:
    "repeat" f64, "repeat.bit" bool, "repeat.vector" Vector, "repeat.polar" Polar, "repeat.pulse" Pulse,
    "repeat.map" Map, "repeat.pose" Pose,
);

struct Repeat<T> {
    every: Span,
    patience: Span,
    next: Option<Time>,
    types: PhantomData<T>,
}

impl<T: Payload> Repeat<T> {
    const INPUTS: &'static [Port] = &[input(T::KIND, "what to repeat")];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the newest message, again and again")];
    const PARAMETERS: &'static [Parameter] = &[
        span("every", "time between two repetitions"),
        span_or_none(
            "patience",
            "how long after it was written a message is repeated; for ever if not given",
        ),
    ];
    const IN: In<T> = In::at(0);
    const OUT: Out<T> = Out::at(0);

    fn new(settings: &Settings<'_>) -> Repeat<T> {
        Repeat {
            every: settings.span("every"),
            patience: settings.span("patience"),
            next: None,
            types: PhantomData,
        }
    }
}

impl<T: Payload + Send> Module for Repeat<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        if let Some(message) = beat.arrived(Self::IN) {
            self.next = Some(now + self.every);
            beat.emit(Self::OUT, message);
            return;
        }
        let (Some(message), Some(stamp)) = (beat.latest(Self::IN), beat.stamp(Self::IN)) else {
            return;
        };
        if self.patience > Span::ZERO && now.since(stamp) >= self.patience {
            self.next = None;
        }
        if let Some(next) = self.next.filter(|next| *next <= now) {
            // On the grid of the first, however late this beat is.
            let missed = now.since(next).0 / self.every.0;
            self.next = Some(next + Span((missed + 1) * self.every.0));
            beat.emit(Self::OUT, message);
        }
    }

    fn reset(&mut self) {
        self.next = None;
    }

    fn state(&self) -> &'static str {
        if self.next.is_some() {
            "repeating"
        } else {
            "silent"
        }
    }
}
