//! `constant`: one message, at the first beat and as often as wanted after it.
//!
//! ```text
//!  Sending ──timer 0, every, 2·every, … / out := value──► Sending
//! ```
//! Without `every` it is sent once: the registers that it reaches keep it. What the body takes grows stale, so
//! a constant for the body has a period. Times count from the first beat after the start or a reset.

use afsm::{Beat, Module, Out, Settings};
use ipc::clock::Span;
use ipc::message::{Kind, Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use super::given;
use crate::declare::{out, span_or_none};
use crate::family::family;
use crate::schedule::Schedule;

const ABOUT: &str = "emits one message at its first beat, and again every so often";
const DIAGRAM: &str = "Sending --timer: 0, every, 2*every, .../out := value--> Sending";
const EVERY: Parameter = span_or_none("every", "time between two messages; once only if not given");

family!(Constant:
    "constant" f64, "constant.bit" bool, "constant.vector" Vector, "constant.polar" Polar,
    "constant.pulse" Pulse, "constant.map" Map, "constant.pose" Pose,
);

struct Constant<T> {
    value: T,
    schedule: Schedule,
}

impl<T: Payload> Constant<T> {
    const INPUTS: &'static [Port] = &[];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the message")];
    const PARAMETERS: &'static [Parameter] = match T::KIND {
        Kind::Pulse => &[EVERY],
        _ => &[given::value(T::KIND), EVERY],
    };
    const OUT: Out<T> = Out::at(0);

    fn new(settings: &Settings<'_>) -> Constant<T> {
        Constant {
            value: given::message(settings),
            schedule: Schedule::new(&[Span::ZERO], settings.span("every")),
        }
    }
}

impl<T: Payload + Send> Module for Constant<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if self.schedule.due(beat.now()).is_some() {
            beat.emit(Self::OUT, self.value);
        }
    }

    fn reset(&mut self) {
        self.schedule.reset();
    }

    fn state(&self) -> &'static str {
        self.schedule.state()
    }
}
