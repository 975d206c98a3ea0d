//! `allen.trail`: drops crumbs on the way and follows them back.
//!
//! ```text
//!               hungry / calm                          at the first crumb / stay
//!  Dropping ──────────────────► Returning ──────────────────────────────────────► Home
//!     ▲ └─ a step on: crumb ─┘     └─ every report: heading of the last crumb ─┘    │
//!     └───────────────────────────── no longer hungry ──────────────────────────────┘
//! ```
//! A crumb that the robot comes near again cuts off the loop between: what is kept is a way without detours,
//! never more than [`CRUMBS_MAX`] crumbs of it. When the wheels were wrong about one it is passed over after a
//! while.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Pose, Pulse};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::Spot;

const POSE: In<Pose> = In::at(0);
const HUNGRY: In<bool> = In::at(1);
const HEADING: Out<f64> = Out::at(0);
const CALM: Out<Pulse> = Out::at(1);
const STAY: Out<Pulse> = Out::at(2);

/// Most crumbs: a way without loops through an office of 500 m², at three quarters of a metre each, is
/// shorter.
pub const CRUMBS_MAX: usize = 128;
/// How often it speaks.
const EVERY: Span = Span::millis(250);

/// The kind `allen.trail`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Trail::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.trail",
    about: "drops crumbs on the way and follows them back when the robot is hungry",
    diagram: "Dropping --hungry/calm--> Returning --at the first crumb/stay--> Home --not hungry--> Dropping",
    inputs: &[
        Port::new("pose", Kind::Pose, "where the wheels think the robot is"),
        Port::new("hungry", Kind::Bit, "whether it must go home"),
    ],
    outputs: &[
        Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad"),
        Port::new("calm", Kind::Pulse, "no setting out for other places now"),
        Port::new("stay", Kind::Pulse, "this is home: no going anywhere"),
    ],
    parameters: &[
        Parameter::number("step", 0.75, "from crumb to crumb")
            .between(0.05, 10.0)
            .unit("m"),
        Parameter::number("near", 0.5, "how near a crumb is there")
            .between(0.05, 10.0)
            .unit("m"),
        Parameter::span("patience", Span::secs(60), "after this one crumb is passed over"),
    ],
};

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Dropping,
    Returning { since: Time },
    Home,
}

struct Trail {
    state: State,
    crumbs: [Spot; CRUMBS_MAX],
    dropped: usize,
    next: Time,
    step: f64,
    near: f64,
    patience: Span,
}

impl Trail {
    fn new(settings: &Settings<'_>) -> Trail {
        Trail {
            state: State::Dropping,
            crumbs: [Spot::default(); CRUMBS_MAX],
            dropped: 0,
            next: Time::ZERO,
            step: settings.number("step"),
            near: settings.number("near"),
            patience: settings.span("patience"),
        }
    }

    /// m from `pose` to the `index`-th crumb.
    fn to(&self, index: usize, pose: Pose) -> f64 {
        libm::hypot(self.crumbs[index].x - pose.x, self.crumbs[index].y - pose.y)
    }

    fn drop_crumb(&mut self, pose: Pose) {
        // The first crumb that is near again is the end of the trail: what lies between was a loop.
        if let Some(again) = (0..self.dropped).find(|&i| self.to(i, pose) < self.step) {
            self.dropped = again + 1;
        } else if self.dropped < CRUMBS_MAX {
            let (x, y) = (pose.x, pose.y);
            self.crumbs[self.dropped] = Spot { x, y };
            self.dropped += 1;
        }
    }

    /// The heading of the crumb to make for; none at home.
    fn homeward(&mut self, pose: Pose, now: Time, since: Time) -> Option<f64> {
        let last = self.dropped.checked_sub(1)?;
        let late = now.since(since) >= self.patience;
        if self.to(last, pose) < self.near || (late && last > 0) {
            self.state = State::Returning { since: now };
            if last == 0 {
                return None;
            }
            self.dropped = last;
        }
        let crumb = self.crumbs[self.dropped - 1];
        Some(libm::atan2(crumb.y - pose.y, crumb.x - pose.x))
    }
}

impl Module for Trail {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let Some(pose) = beat.latest(POSE) else { return };
        if now < self.next {
            return;
        }
        self.next = now + EVERY;
        let hungry = beat.latest(HUNGRY).unwrap_or(false);
        match self.state {
            State::Dropping if hungry => self.state = State::Returning { since: now },
            State::Dropping => self.drop_crumb(pose),
            State::Returning { .. } | State::Home if !hungry => self.state = State::Dropping,
            State::Returning { since } => match self.homeward(pose, now, since) {
                Some(heading) => beat.emit(HEADING, heading),
                None => self.state = State::Home,
            },
            State::Home if self.to(0, pose) > self.step => self.state = State::Returning { since: now },
            State::Home => beat.emit(STAY, Pulse),
        }
        if hungry {
            beat.emit(CALM, Pulse);
        }
    }

    fn reset(&mut self) {
        self.state = State::Dropping;
        self.dropped = 0;
        self.next = Time::ZERO;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Dropping => "dropping",
            State::Returning { .. } => "returning",
            State::Home => "home",
        }
    }
}
