//! `integrator`: adds a number up over time, between limits.
//!
//! ```text
//!  Waiting ──in / out := start──► Summing ──in, written dt after the one before / out := out + before·dt──► Summing
//! ```
//! Each message holds until the next one (in the unit of `in` times s). The sum stops at its limits and leaves them
//! at once when the sign changes: nothing winds up behind them. Should `low` lie above `high`, the sum is `high`.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::declare::{NUMBER_MAX, input, number, out};

const IN: In<f64> = In::at(0);
const OUT: Out<f64> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "integrator",
        about: "adds a number up over time, between limits",
        diagram: "Waiting --in/out := start--> Summing --in, written dt after the one before/\
            out := out + before*dt, kept between low and high--> Summing",
        inputs: &[input(Kind::Number, "what to add up; holds until the next")],
        outputs: &[out(Kind::Number, "the sum, for each message")],
        parameters: &[
            number("start", 0.0, "[in]*s", "the sum before the first message"),
            number("low", -NUMBER_MAX, "[in]*s", "smallest sum"),
            number("high", NUMBER_MAX, "[in]*s", "largest sum"),
        ],
    },
    build: |s| Box::new(Integrator::new(s)),
}];

struct Integrator {
    start: f64,
    low: f64,
    high: f64,
    sum: f64,
    /// The message that holds, and since when.
    before: Option<(Time, f64)>,
}

impl Integrator {
    fn new(settings: &Settings<'_>) -> Integrator {
        let mut integrator = Integrator {
            start: settings.number("start"),
            low: settings.number("low"),
            high: settings.number("high"),
            sum: 0.0,
            before: None,
        };
        integrator.reset();
        integrator
    }
}

impl Module for Integrator {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let (Some(number), Some(stamp)) = (beat.arrived(IN), beat.stamp(IN)) else {
            return;
        };
        if let Some((since, before)) = self.before {
            // An addend beyond all numbers ends at a limit as any other: both limits are numbers.
            let sum = self.sum + before * stamp.since(since).seconds();
            self.sum = sum.max(self.low).min(self.high);
        }
        self.before = Some((stamp, number));
        beat.emit(OUT, self.sum);
    }

    fn reset(&mut self) {
        self.sum = self.start.max(self.low).min(self.high);
        self.before = None;
    }

    fn state(&self) -> &'static str {
        match self.before {
            None => "waiting",
            Some(_) if self.sum >= self.high => "at-high",
            Some(_) if self.sum <= self.low => "at-low",
            Some(_) => "summing",
        }
    }
}
