//! `source`: messages at given times, and periodically after them.
//!
//! ```text
//!  Sending ──timer at[k] / out := values[k]──► Sending ──last──► Done
//!                                                └─ with a period: again every … ─► Sending
//! ```
//! Times count from the first beat after the start or a reset. Of several messages due at one beat the newest is
//! sent. Without times and period it sends nothing of its own: a place where a trial can put messages on a wire.

use afsm::{Beat, Module, Out, Settings};
use ipc::message::{Kind, Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port, Takes};

use super::given::{self, MESSAGES_MAX};
use crate::declare::{out, span_or_none};
use crate::family::family;
use crate::schedule::Schedule;

const ABOUT: &str = "emits messages at given times, and periodically after them";
const DIAGRAM: &str = "Sending --timer at[k], then every/out := values[k]--> Sending --last--> Done";
const AT: Parameter = Parameter::new(
    "at",
    Takes::Spans {
        most: MESSAGES_MAX,
        default: Some(&[]),
    },
    "when to send, counted from the first beat",
);
const EVERY: Parameter = span_or_none(
    "every",
    "period from the last of these times on, or from the first beat",
);

family!(Sequence:
    "source" f64, "source.bit" bool, "source.vector" Vector, "source.polar" Polar,
    "source.pulse" Pulse, "source.map" Map, "source.pose" Pose,
);

struct Sequence<T> {
    values: Box<[T]>,
    schedule: Schedule,
}

impl<T: Payload> Sequence<T> {
    const INPUTS: &'static [Port] = &[];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the messages")];
    const PARAMETERS: &'static [Parameter] = match T::KIND {
        Kind::Pulse => &[AT, EVERY],
        _ => &[AT, EVERY, given::values(T::KIND)],
    };
    const OUT: Out<T> = Out::at(0);

    fn new(settings: &Settings<'_>) -> Sequence<T> {
        Sequence {
            values: given::messages(settings),
            schedule: Schedule::new(settings.spans("at"), settings.span("every")),
        }
    }
}

impl<T: Payload + Send> Module for Sequence<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if let Some(number) = self.schedule.due(beat.now()) {
            let index = number % self.values.len() as u64;
            beat.emit(Self::OUT, self.values[index as usize]);
        }
    }

    fn reset(&mut self) {
        self.schedule.reset();
    }

    fn state(&self) -> &'static str {
        self.schedule.state()
    }
}
