//! `low-pass`: smooths a number, first order.
//!
//! ```text
//!  Waiting ──in / out := in──► Smoothing ──in, written dt after the one before / out := out + k·(in - out)──► Smoothing
//!  k = 1 - exp(-dt / time_constant)
//! ```
//! In the unit of `in`. Messages may come at any intervals: what was heard a time constant ago counts for 1/e.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::declare::{input, out, span};

const IN: In<f64> = In::at(0);
const OUT: Out<f64> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "low-pass",
        about: "smooths a number",
        diagram: "Waiting --in/out := in--> Smoothing --in, written dt after the one before/\
            out := out + k*(in - out), k = 1 - exp(-dt/time_constant)--> Smoothing",
        inputs: &[input(Kind::Number, "what to smooth")],
        outputs: &[out(Kind::Number, "the smoothed number, for each message")],
        parameters: &[span(
            "time_constant",
            "after this long an old value counts for 1/e",
        )],
    },
    build: |s| Box::new(LowPass::new(s)),
}];

struct LowPass {
    time_constant: Span,
    last: Option<(Time, f64)>,
}

impl LowPass {
    fn new(settings: &Settings<'_>) -> LowPass {
        LowPass {
            time_constant: settings.span("time_constant"),
            last: None,
        }
    }
}

impl Module for LowPass {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let (Some(number), Some(stamp)) = (beat.arrived(IN), beat.stamp(IN)) else {
            return;
        };
        let smoothed = self.last.map_or(number, |(since, last)| {
            let old = libm::exp(-stamp.since(since).seconds() / self.time_constant.seconds());
            // Between the two, so always a number.
            old * last + (1.0 - old) * number
        });
        self.last = Some((stamp, smoothed));
        beat.emit(OUT, smoothed);
    }

    fn reset(&mut self) {
        self.last = None;
    }

    fn state(&self) -> &'static str {
        if self.last.is_some() {
            "smoothing"
        } else {
            "waiting"
        }
    }
}
