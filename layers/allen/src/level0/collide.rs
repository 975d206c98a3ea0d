//! `allen.collide`: watches whether the way dead ahead is clear, and sends halt messages while it is not.
//!
//! ```text
//!  Blind ──map──► Watching: every beat, if something could be met before the next map: halt
//!    ▲                │ no map for `blind`
//!    └────────────────┘   (blind: halt as well)
//! ```
//! A map is a second old before the next one comes. What it showed is therefore moved towards the robot by
//! the way both can have come since: the robot at its full speed, whatever else there is at a walking
//! pace. The map is turned as the compass turns, so that *ahead* is ahead of the robot as it stands now.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pulse};
use ipc::wiring::{Declaration, Parameter, Port, Takes};

use crate::geometry::{HALF_CONE, bearing, wrap};

const MAP: In<Map> = In::at(0);
const COMPASS: In<f64> = In::at(1);
const HALT: Out<Pulse> = Out::at(0);

/// The kind `allen.collide`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Collide::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.collide",
    about: "sends halt messages while something is, or could by now be, dead ahead",
    diagram: "Blind --map--> Watching --(range - way both came since the map < margin)--/halt--> Watching",
    inputs: &[
        Port::new("map", Kind::Map, "a sonar map")
            .unit("m")
            .between(0.0, 100.0),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    ],
    outputs: &[Port::new("halt", Kind::Pulse, "do not drive forward")],
    parameters: &[
        number("radius", 0.2, "m", "radius of the robot"),
        number("speed", 0.3, "m/s", "full speed of the robot"),
        number("pace", 0.75, "m/s", "pace at which people walk into the robot"),
        number(
            "margin",
            0.2,
            "m",
            "room to keep to what stands, braking way included",
        ),
        number("side", 0.06, "m", "room to keep at the side when passing"),
        Parameter {
            name: "blind",
            takes: Takes::Span {
                default: Some(Span::millis(1600)),
            },
            unit: "",
            about: "a map older than this says nothing any more",
        },
    ],
};

const fn number(name: &'static str, default: f64, unit: &'static str, about: &'static str) -> Parameter {
    Parameter {
        name,
        takes: Takes::Number {
            low: 0.0,
            high: 100.0,
            default: Some(default),
        },
        unit,
        about,
    }
}

/// Room kept to what may be walking, metres.
const WALKING_MARGIN_M: f64 = 0.1;
/// An echo nearer than this does not vanish within a second unless it was lost: the older one stands.
const NEAR_ECHO_M: f64 = 2.0;
/// Farther than anything within a second's reach: no echo.
const NO_ECHO_M: f64 = 5.0;

/// A map with the heading and time at which it was taken.
#[derive(Clone, Copy)]
struct Taken {
    map: Map,
    heading: f64,
    at: Time,
}

// A module is in one state at a time; boxing the large one would save nothing and allocate in a step.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy)]
enum State {
    Blind,
    Watching { newest: Taken, before: Option<Taken> },
}

struct Collide {
    state: State,
    radius: f64,
    speed: f64,
    pace: f64,
    margin: f64,
    side: f64,
    blind: Span,
}

impl Collide {
    fn new(settings: &Settings<'_>) -> Collide {
        Collide {
            state: State::Blind,
            radius: settings.number("radius"),
            speed: settings.number("speed"),
            pace: settings.number("pace"),
            margin: settings.number("margin"),
            side: settings.number("side"),
            blind: settings.span("blind"),
        }
    }

    /// Whether something seen at `range` and `off` the way ahead can be in it after `age` seconds.
    fn in_the_way(&self, range: f64, off: f64, age: f64) -> bool {
        // The echo came from anywhere in the cone; the nearest to dead ahead counts.
        let off = (off.abs() - HALF_CONE).max(0.0);
        let towards = libm::cos(off);
        if off >= core::f64::consts::FRAC_PI_3 + HALF_CONE {
            return false;
        }
        let aside = (range + self.radius) * libm::sin(off);
        let stands = aside < self.radius + self.side && range - age * self.speed * towards < self.margin;
        let walks = range - age * (self.speed * towards + self.pace) < WALKING_MARGIN_M;
        stands || walks
    }

    fn blocked(&self, taken: &Taken, heading: f64, now: Time, counts: impl Fn(usize, f64) -> bool) -> bool {
        let age = now.since(taken.at).seconds();
        let turned = heading - taken.heading;
        taken.map.ranges.iter().enumerate().any(|(index, range)| {
            counts(index, *range) && self.in_the_way(*range, wrap(bearing(index) - turned), age)
        })
    }
}

impl Module for Collide {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let Some(heading) = beat.latest(COMPASS) else {
            beat.emit(HALT, Pulse);
            return;
        };
        if let Some(map) = beat.arrived(MAP) {
            let before = match self.state {
                State::Watching { newest, .. } => Some(newest),
                State::Blind => None,
            };
            let at = beat.stamp(MAP).unwrap_or(now);
            self.state = State::Watching {
                newest: Taken { map, heading, at },
                before,
            };
        }
        let halt = match &self.state {
            State::Blind => true,
            State::Watching { newest, .. } if now.since(newest.at) > self.blind => {
                self.state = State::Blind;
                true
            }
            State::Watching { newest, before } => {
                let lost = |older: &Taken| {
                    let map = newest.map;
                    self.blocked(older, heading, now, |i, r| {
                        r < NEAR_ECHO_M && map.ranges[i] > NO_ECHO_M
                    })
                };
                self.blocked(newest, heading, now, |_, _| true) || before.as_ref().is_some_and(lost)
            }
        };
        if halt {
            beat.emit(HALT, Pulse);
        }
    }

    fn reset(&mut self) {
        self.state = State::Blind;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Blind => "blind",
            State::Watching { .. } => "watching",
        }
    }
}
