//! `allen.follow`: sees something move before the robot and makes for it.
//!
//! ```text
//!          something ahead is where nothing was / heading          `most` over, or `lose` without it
//!  Alone ────────────────────────────────────────────────► After ─────────────────────────────────► Bored
//!    ▲                                                      └─ seen to move / heading ─┘              │
//!    └────────────────────────────────────── time: `bored` ───────────────────────────────────────────┘
//! ```
//! Two maps are compared on the floor, as the wheels say where they were taken. A robot that turned in between
//! sees everything move, so what it sees then does not count. Keeping off the person is level 0's affair.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pose, SONARS};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::{Spot, bearing, wrap};

const MAP: In<Map> = In::at(0);
const POSE: In<Pose> = In::at(1);
const HEADING: Out<f64> = Out::at(0);

/// The sonars that look ahead: straight, and sixty degrees to either side.
const AHEAD: [usize; 5] = [0, 1, 11, 2, 10];
/// Farther than this from everything heard a map ago it has moved, metres: half a step.
const MOVED_M: f64 = 0.35;
/// A robot that turned more than this between two maps cannot tell, radians.
const TURNED_RAD: f64 = 0.15;
/// From the rim to the middle of the robot, metres.
const RIM_M: f64 = 0.2;

/// The kind `allen.follow`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Follow::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.follow",
    about: "makes for what moves before the robot, for a while",
    diagram: "Alone --something moved ahead/heading--> After --most over, or lost--> Bored --time--> Alone",
    inputs: &[
        Port::new("map", Kind::Map, "a sonar map")
            .unit("m")
            .between(0.0, 100.0),
        Port::new("pose", Kind::Pose, "where the wheels think the robot is"),
    ],
    outputs: &[Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad")],
    parameters: &[
        Parameter::number("reach", 2.5, "whoever is farther is left alone")
            .between(0.0, 10.0)
            .unit("m"),
        Parameter::span("most", Span::secs(15), "how long to follow anybody"),
        Parameter::span("lose", Span::secs(4), "how long without seeing a movement"),
        Parameter::span("bored", Span::secs(90), "how long to leave people alone after"),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Alone,
    After { until: Time, seen: Time },
    Bored { until: Time },
}

struct Follow {
    state: State,
    /// What the map before heard, on the floor, and the heading it was taken at.
    before: Option<([Option<Spot>; SONARS], f64)>,
    reach: f64,
    most: Span,
    lose: Span,
    bored: Span,
}

impl Follow {
    fn new(settings: &Settings<'_>) -> Follow {
        Follow {
            state: State::Alone,
            before: None,
            reach: settings.number("reach"),
            most: settings.span("most"),
            lose: settings.span("lose"),
            bored: settings.span("bored"),
        }
    }

    /// Where the nearest thing ahead is that was not there a map ago.
    fn moving(&mut self, map: &Map, pose: Pose) -> Option<Spot> {
        let spot = |i: usize| Spot::from(pose, map.ranges[i] + RIM_M, bearing(i));
        let heard = core::array::from_fn(|i| (map.ranges[i] < 2.0 * self.reach).then(|| spot(i)));
        let (old, heading) = self.before.replace((heard, pose.heading))?;
        if wrap(pose.heading - heading).abs() > TURNED_RAD {
            return None;
        }
        let apart = |a: &Spot, b: &Spot| libm::hypot(a.x - b.x, a.y - b.y);
        let near = AHEAD.iter().copied().filter(|&i| map.ranges[i] < self.reach);
        let moved = near.filter(|&i| old.iter().flatten().all(|was| apart(was, &spot(i)) > MOVED_M));
        let nearest = moved.min_by(|&a, &b| map.ranges[a].total_cmp(&map.ranges[b]))?;
        Some(spot(nearest))
    }
}

impl Module for Follow {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let (Some(map), Some(pose)) = (beat.arrived(MAP), beat.latest(POSE)) else {
            return;
        };
        let moving = self.moving(&map, pose);
        match (self.state, moving) {
            (State::Bored { until }, _) if now < until => return,
            (State::Bored { .. }, None) => self.state = State::Alone,
            (State::Alone | State::Bored { .. }, Some(_)) => {
                self.state = State::After {
                    until: now + self.most,
                    seen: now,
                };
            }
            (State::After { until, .. }, Some(_)) if now < until => {
                self.state = State::After { until, seen: now };
            }
            (State::After { until, seen }, _) if now >= until || now.since(seen) >= self.lose => {
                self.state = State::Bored {
                    until: now + self.bored,
                };
            }
            _ => {}
        }
        if let (State::After { .. }, Some(spot)) = (self.state, moving) {
            beat.emit(HEADING, libm::atan2(spot.y - pose.y, spot.x - pose.x));
        }
    }

    fn reset(&mut self) {
        self.state = State::Alone;
        self.before = None;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Alone => "alone",
            State::After { .. } => "after",
            State::Bored { .. } => "bored",
        }
    }
}
