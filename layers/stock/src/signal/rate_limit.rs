//! `rate-limit`: follows a number no faster than it may.
//!
//! ```text
//!  Resting ──in / out──► Moving: every beat, out := out moved towards in, at most rise or fall per second
//!     ▲                     │ out = in
//!     └─────────────────────┘
//! ```
//! Emits at every beat while it moves, the last time when it has arrived, and for every message. It moves towards
//! a message from the moment that was written, starting from `start`.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::declare::{input, number, out, positive};

const IN: In<f64> = In::at(0);
const OUT: Out<f64> = Out::at(0);

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "rate-limit",
        about: "follows a number no faster than it may; emits every beat while it moves",
        diagram: "Resting --in/out--> Moving --every beat/out := out moved towards in, by at most rise*dt up or \
            fall*dt down--> Moving --out = in--> Resting",
        inputs: &[input(Kind::Number, "where to go")],
        outputs: &[out(Kind::Number, "how far it is")],
        parameters: &[
            positive("rise", 1.0, "[in]/s", "how fast it may go up"),
            positive("fall", 1.0, "[in]/s", "how fast it may go down"),
            number("start", 0.0, "[in]", "where it is before the first message"),
        ],
    },
    build: |s| Box::new(RateLimit::new(s)),
}];

struct RateLimit {
    rise: f64,
    fall: f64,
    start: f64,
    value: f64,
    target: Option<f64>,
    /// When `value` was worked out.
    at: Time,
}

impl RateLimit {
    fn new(settings: &Settings<'_>) -> RateLimit {
        let start = settings.number("start");
        RateLimit {
            rise: settings.number("rise"),
            fall: settings.number("fall"),
            start,
            value: start,
            target: None,
            at: Time::ZERO,
        }
    }

    /// Moves until `then`.
    fn go(&mut self, then: Time) {
        let span = then.since(self.at);
        self.at = self.at.max(then);
        let Some(target) = self.target.filter(|_| span > Span::ZERO) else {
            return;
        };
        let step = (target - self.value).clamp(-self.fall * span.seconds(), self.rise * span.seconds());
        self.value += step;
        // Rounding must not leave it beside its goal for ever.
        if (target - self.value).abs() <= f64::EPSILON * target.abs() {
            self.value = target;
        }
    }
}

impl Module for RateLimit {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let arrived = beat.arrived(IN);
        let moving = self.target.is_some_and(|target| target != self.value);
        if let (Some(target), Some(stamp)) = (arrived, beat.stamp(IN)) {
            self.go(stamp);
            self.target = Some(target);
        }
        self.go(now);
        if arrived.is_some() || moving {
            beat.emit(OUT, self.value);
        }
    }

    fn reset(&mut self) {
        self.value = self.start;
        self.target = None;
    }

    fn state(&self) -> &'static str {
        match self.target {
            Some(target) if target != self.value => "moving",
            _ => "resting",
        }
    }
}
