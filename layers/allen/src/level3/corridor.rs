//! `allen.corridor`: notices a wall on either side and leads along the middle between them.
//!
//! ```text
//!            walls on both sides, free ahead / heading          no more, or `most` over
//!  Roaming ─────────────────────────────────────────► Along ───────────────────────────► Weary
//!     ▲                                                └─ every map: heading ─┘            │
//!     └──────────────────────────────── time: `weary` ─────────────────────────────────────┘
//! ```
//! What it knows of a corridor is one map: two ranges that make a passage, and where between them it is.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::wrap;

const MAP: In<Map> = In::at(0);
const COMPASS: In<f64> = In::at(1);
const HEADING: Out<f64> = Out::at(0);

/// Sonars straight ahead, to the left and to the right.
const AHEAD: usize = 0;
const LEFT: usize = 3;
const RIGHT: usize = 9;
/// How much to steer for a metre off the middle, rad/m, and at most, rad.
const STEER: (f64, f64) = (0.4, 0.35);

/// The kind `allen.corridor`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Corridor::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.corridor",
    about: "leads along the middle between two walls",
    diagram: "Roaming --walls on both sides/heading--> Along --no more, or most over--> Weary --time--> Roaming",
    inputs: &[
        Port::new("map", Kind::Map, "a sonar map")
            .unit("m")
            .between(0.0, 100.0),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    ],
    outputs: &[Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad")],
    parameters: &[
        Parameter::number(
            "widest",
            2.2,
            "walls farther apart than this, rim to wall on both sides, are no corridor",
        )
        .between(0.0, 20.0)
        .unit("m"),
        Parameter::number("ahead", 1.2, "what must be free ahead")
            .between(0.0, 20.0)
            .unit("m"),
        Parameter::span("most", Span::secs(20), "how long to follow one at a time"),
        Parameter::span("weary", Span::secs(40), "how long to leave the next one alone"),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Roaming,
    Along { until: Time },
    Weary { until: Time },
}

struct Corridor {
    state: State,
    widest: f64,
    ahead: f64,
    most: Span,
    weary: Span,
}

impl Corridor {
    fn new(settings: &Settings<'_>) -> Corridor {
        Corridor {
            state: State::Roaming,
            widest: settings.number("widest"),
            ahead: settings.number("ahead"),
            most: settings.span("most"),
            weary: settings.span("weary"),
        }
    }
}

impl Module for Corridor {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let (Some(map), Some(compass)) = (beat.arrived(MAP), beat.latest(COMPASS)) else {
            return;
        };
        let (left, right) = (map.ranges[LEFT], map.ranges[RIGHT]);
        let between = left + right < self.widest && map.ranges[AHEAD] > self.ahead;
        if let State::Weary { until } = self.state
            && now >= until
        {
            self.state = State::Roaming;
        }
        match self.state {
            State::Roaming if between => {
                self.state = State::Along {
                    until: now + self.most,
                };
            }
            State::Along { until } if !between || now >= until => {
                self.state = State::Weary {
                    until: now + self.weary,
                };
            }
            _ => {}
        }
        if let State::Along { .. } = self.state {
            let steer = (STEER.0 * (left - right)).clamp(-STEER.1, STEER.1);
            beat.emit(HEADING, wrap(compass + steer));
        }
    }

    fn reset(&mut self) {
        self.state = State::Roaming;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Roaming => "roaming",
            State::Along { .. } => "along",
            State::Weary { .. } => "weary",
        }
    }
}
