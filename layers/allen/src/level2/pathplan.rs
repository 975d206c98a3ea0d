//! `allen.pathplan`: makes for the end of a path by commanding headings: a difference engine.
//!
//! ```text
//!          path / goal := path by the compass, start
//!  Idle ───────────────────────────────────────────► Pursuing ──travelled / heading of goal - travelled──┐
//!    ▲                                                 │  ▲                                              │
//!    │   |goal - travelled| < near / reached           │  └──────────────────────────────────────────────┘
//!    ├─────────────────────────────────────────────────┤
//!    └── no nearer for `patience` / given_up ──────────┘
//! ```
//! What turns the robot aside on the way is none of its business: the difference that is left says where to
//! (Brooks 1991 §6.2). A path that arrives while it pursues one is ignored.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Polar, Pulse, Vector};
use ipc::wiring::{Declaration, Parameter, Port};

const PATH: In<Polar> = In::at(0);
const TRAVELLED: In<Vector> = In::at(1);
const COMPASS: In<f64> = In::at(2);
const HEADING: Out<f64> = Out::at(0);
const START: Out<Pulse> = Out::at(1);
const PURSUING: Out<bool> = Out::at(2);
const REACHED: Out<Pulse> = Out::at(3);
const GIVEN_UP: Out<Pulse> = Out::at(4);

/// So much nearer counts as headway, metres: what slip makes of standing still is less.
const HEADWAY_M: f64 = 0.1;

/// The kind `allen.pathplan`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(PathPlan::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.pathplan",
    about: "makes for the end of a path: commands the heading of what is left of it",
    diagram: "Idle --path/start--> Pursuing --travelled/heading of the difference--> Pursuing \
              --near/reached, or no headway/given_up--> Idle",
    inputs: &[
        Port::new(
            "path",
            Kind::Polar,
            "how far, m, and which way, in the robot's frame",
        ),
        Port::new(
            "travelled",
            Kind::Vector,
            "the way since the start, by the compass",
        )
        .unit("m"),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    ],
    outputs: &[
        Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad"),
        Port::new("start", Kind::Pulse, "a place was chosen: measure from here"),
        Port::new(
            "pursuing",
            Kind::Bit,
            "whether a place is being made for, every report",
        ),
        Port::new("reached", Kind::Pulse, "the robot is there"),
        Port::new("given_up", Kind::Pulse, "there was no getting nearer"),
    ],
    parameters: &[
        Parameter::number("near", 0.5, "how near a place is there")
            .between(0.05, 10.0)
            .unit("m"),
        Parameter::span(
            "patience",
            Span::secs(60),
            "how long it may take to get nearer at all",
        ),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Idle,
    Pursuing {
        goal: Vector,
        nearest: f64,
        nearer_at: Time,
    },
}

struct PathPlan {
    state: State,
    near: f64,
    patience: Span,
}

impl PathPlan {
    fn new(settings: &Settings<'_>) -> PathPlan {
        PathPlan {
            state: State::Idle,
            near: settings.number("near"),
            patience: settings.span("patience"),
        }
    }

    fn set_out(&mut self, beat: &mut Beat<'_>) {
        let (Some(path), Some(compass)) = (beat.arrived(PATH), beat.latest(COMPASS)) else {
            return;
        };
        let way = compass + path.bearing;
        let goal = Vector {
            x: path.length * libm::cos(way),
            y: path.length * libm::sin(way),
        };
        beat.emit(START, Pulse);
        beat.emit(PURSUING, true);
        beat.emit(HEADING, way);
        self.state = State::Pursuing {
            goal,
            nearest: path.length,
            nearer_at: beat.now(),
        };
    }

    fn pursue(&mut self, beat: &mut Beat<'_>, goal: Vector, mut nearest: f64, mut nearer_at: Time) {
        // What integrate said before it heard of this start is of another way.
        let Some(travelled) = beat.arrived(TRAVELLED) else {
            return;
        };
        let now = beat.now();
        let (x, y) = (goal.x - travelled.x, goal.y - travelled.y);
        let left = libm::hypot(x, y);
        if left < nearest - HEADWAY_M {
            (nearest, nearer_at) = (left, now);
        }
        let given_up = now.since(nearer_at) >= self.patience;
        if left < self.near || given_up {
            beat.emit(if given_up { GIVEN_UP } else { REACHED }, Pulse);
            beat.emit(PURSUING, false);
            self.state = State::Idle;
            return;
        }
        beat.emit(HEADING, libm::atan2(y, x));
        beat.emit(PURSUING, true);
        self.state = State::Pursuing {
            goal,
            nearest,
            nearer_at,
        };
    }
}

impl Module for PathPlan {
    fn step(&mut self, beat: &mut Beat<'_>) {
        match self.state {
            State::Idle => self.set_out(beat),
            State::Pursuing {
                goal,
                nearest,
                nearer_at,
            } => self.pursue(beat, goal, nearest, nearer_at),
        }
    }

    fn reset(&mut self) {
        self.state = State::Idle;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Idle => "idle",
            State::Pursuing { .. } => "pursuing",
        }
    }
}
