//! `allen.collide`: watches whether the way ahead is clear, and sends halt messages while it is not.
//!
//! ```text
//!  Blind ──map──► Watching: every beat, if something could be met before the robot stands: halt
//!    ▲                │ no map for `blind`
//!    └────────────────┘   (blind: halt as well)
//! ```
//! A map is a second old before the next one comes, and a person crosses the reach of an arm in that time.
//! What the map showed is therefore kept as *marks*, points of the floor; the robot is moved among them as
//! odometry and compass say, plus the way it needs to stop; and a mark matters as soon as whoever stood there
//! could by then, at a walking pace, have come to the front half of the robot. What touches the back was not
//! driven into.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pose, Pulse, SONARS};
use ipc::wiring::{Declaration, Parameter, Port, Takes};

use crate::geometry::{HALF_CONE, Spot, bearing, wrap};

const MAP: In<Map> = In::at(0);
const POSE: In<Pose> = In::at(1);
const HALT: Out<Pulse> = Out::at(0);

/// The kind `allen.collide`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Collide::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.collide",
    about: "sends halt messages while something is ahead, or could be before the robot has stopped",
    diagram: "Blind --map--> Watching --(something could be met before the robot stands)/halt--> Watching",
    inputs: &[
        Port::new("map", Kind::Map, "a sonar map")
            .unit("m")
            .between(0.0, 100.0),
        Port::new(
            "pose",
            Kind::Pose,
            "where the wheels think the robot is, which way it faces",
        ),
    ],
    outputs: &[Port::new("halt", Kind::Pulse, "do not drive forward")],
    parameters: &[
        number("radius", 0.2, "m", "radius of the robot"),
        number("speed", 0.3, "m/s", "full speed of the robot"),
        number("pace", 0.75, "m/s", "pace at which people walk into the robot"),
        number("margin", 0.05, "m", "room to keep, for what the pose is off by"),
        Parameter {
            name: "stop",
            takes: Takes::Span {
                default: Some(Span::millis(350)),
            },
            unit: "",
            about: "from a halt message to a robot that stands",
        },
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

/// Marks farther than this are out of reach: people and robot meet at 1.05 m/s, a map serves 1.6 s at most.
const FAR_M: f64 = 2.2;
/// Farther than anything within a second's reach: no echo.
const NO_ECHO_M: f64 = 5.0;
/// Radius of a person: half a shoulder breadth.
const PERSON_M: f64 = 0.22;
/// Backward per sideways from which on a mark lies behind: 30 degrees back from abeam.
const BEHIND: f64 = 0.6;
/// Points that stand for the arc an echo can have come from: its ends and its middle.
const ARC: [f64; 3] = [-HALF_CONE, 0.0, HALF_CONE];

/// What one sonar heard: perhaps a person, somewhere on an arc.
#[derive(Clone, Copy)]
struct Mark {
    /// Points of the floor that the person's middle may have been at.
    arc: [Spot; 3],
    /// When it was heard.
    at: Time,
}

type Marks = [Option<Mark>; SONARS];

// A module is in one state at a time; boxing the large one would save nothing and allocate in a step.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy)]
enum State {
    Blind,
    Watching { marks: Marks, at: Time },
}

struct Collide {
    state: State,
    radius: f64,
    speed: f64,
    pace: f64,
    margin: f64,
    stop: Span,
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
            stop: settings.span("stop"),
            blind: settings.span("blind"),
        }
    }

    /// The marks of a map heard `at` a pose, given those of the map before.
    fn marks(&self, map: &Map, pose: Pose, at: Time, before: &Marks) -> Marks {
        std::array::from_fn(|index| {
            let range = map.ranges[index];
            if range < FAR_M {
                let middle = self.radius + range + PERSON_M;
                let arc = ARC.map(|off| Spot::from(pose, middle, bearing(index) + off));
                return Some(Mark { arc, at });
            }
            // An echo that was near a second ago and now is none was lost: the older one stands for it.
            let lost = |mark: &&Mark| range > NO_ECHO_M && at.since(mark.at) < self.blind;
            let same_way = |mark: &&Mark| {
                let seen = mark.arc[1].seen_from(pose);
                let off = wrap(libm::atan2(seen.y, seen.x) - bearing(index));
                off.abs() <= HALF_CONE
            };
            before.iter().flatten().filter(lost).find(same_way).copied()
        })
    }

    /// Whether the way ahead is barred at `now` for a robot at `pose`.
    fn barred(&self, marks: &Marks, pose: Pose, now: Time) -> bool {
        // Braking takes the robot half as far as it would have gone.
        let way = self.speed * self.stop.seconds() / 2.0;
        let meet = self.radius + PERSON_M + self.margin;
        marks.iter().flatten().any(|mark| {
            let walked = self.pace * (now.since(mark.at) + self.stop).seconds();
            let reaches = |spot: &Spot| {
                let seen = spot.seen_from(pose);
                to_front(seen.x - way, seen.y, meet) < walked
            };
            mark.arc.iter().any(reaches)
        })
    }
}

/// How far it is from (x, y) to the front half of a disc of `radius` about the origin; endless from behind,
/// where the disc itself is in the way.
fn to_front(x: f64, y: f64, radius: f64) -> f64 {
    if x >= 0.0 {
        (libm::hypot(x, y) - radius).max(0.0)
    } else if x < -y.abs() * BEHIND {
        f64::INFINITY
    } else {
        libm::hypot(x, (y.abs() - radius).max(0.0))
    }
}

impl Module for Collide {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let now = beat.now();
        let Some(pose) = beat.latest(POSE) else {
            beat.emit(HALT, Pulse);
            return;
        };
        if let Some(map) = beat.arrived(MAP) {
            let at = beat.stamp(MAP).unwrap_or(now);
            let before = match self.state {
                State::Watching { marks, .. } => marks,
                State::Blind => [None; SONARS],
            };
            let marks = self.marks(&map, pose, at, &before);
            self.state = State::Watching { marks, at };
        }
        if let State::Watching { at, .. } = self.state
            && now.since(at) > self.blind
        {
            self.state = State::Blind;
        }
        let barred = match &self.state {
            State::Blind => true,
            State::Watching { marks, .. } => self.barred(marks, pose, now),
        };
        if barred {
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
