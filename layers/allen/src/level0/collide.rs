//! `allen.collide`: watches whether the way ahead is clear, and sends halt messages while it is not.
//!
//! ```text
//!  Blind ──map──► Watching: every beat, if something could be met before the robot stands: halt
//!    ▲                │ no map for `blind`
//!    └────────────────┘   (blind: halt as well)
//! ```
//! A map is a second old before the next one comes, and a person crosses the reach of an arm in that time.
//! What the map showed is therefore kept as *marks*, points of the floor; the robot is moved among them as
//! odometry and compass say, plus the way it needs to stop at its present speed; and a mark matters as soon
//! as whoever stood there could by then, at a walking pace, have come to the front half of the robot. Where
//! the map before had a mark near it, that one has moved by as much, and walks no faster than who starts is
//! after such a way: who stands has to start before walking, and whoever may hide behind is farther still.
//! What touches the back was not driven into.
//!
//! So the robot is quick where there is room, and goes through a door by short advances, one for each map.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pose, Pulse, SONARS};
use ipc::wiring::{Declaration, Parameter, Port};

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
        Parameter::number("radius", 0.2, "radius of the robot")
            .between(0.0, 100.0)
            .unit("m"),
        Parameter::number("braking", 1.0, "how hard the robot brakes")
            .between(0.0, 100.0)
            .unit("m/s2"),
        Parameter::number("pace", 0.75, "pace at which people walk into the robot")
            .between(0.0, 100.0)
            .unit("m/s"),
        Parameter::number("start", 2.0, "how fast people start to walk")
            .between(0.0, 100.0)
            .unit("m/s2"),
        Parameter::number("margin", 0.05, "room to keep, for what the pose is off by")
            .between(0.0, 100.0)
            .unit("m"),
        Parameter::span(
            "latency",
            Span::millis(60),
            "from a halt message to brakes that grip: a beat of the layer, two of the motor unit",
        ),
        Parameter::span(
            "lost",
            Span::millis(2600),
            "how long an echo that is heard no more stands: two maps, three losses in a row are rare",
        ),
        Parameter::span(
            "blind",
            Span::millis(1600),
            "a map older than this says nothing any more",
        ),
    ],
};

/// Marks farther than this are out of reach: people and robot meet at 1.05 m/s, a map serves 1.6 s at most.
const FAR_M: f64 = 2.2;
/// Farther than anything within a second's reach: no echo.
const NO_ECHO_M: f64 = 5.0;
/// A sonar tells nothing nearer than six inches; what reads about that may as well touch, metres.
const TOUCHING_M: f64 = 0.2;
/// Radius of a person: half a shoulder breadth.
const PERSON_M: f64 = 0.22;
/// Backward per sideways from which on a mark lies behind: 30 degrees back from abeam.
const BEHIND: f64 = 0.6;
/// Nearer than this to where something was a map ago, metres, it is the same: four sigma of a range, and what
/// the pose is off by after a second.
const SAME_M: f64 = 0.15;
/// What came nearer by less than this, metres, stands: two sigma of the difference of two ranges.
const STILL_M: f64 = 0.05;
/// How fast the measured speed follows the odometry, 1/s: over a tenth of a second its slip averages out.
const FOLLOW: f64 = 10.0;
/// What the measured speed may be off by, m/s: slip, and the speed gained before it shows.
const SPEED_OFF_M_S: f64 = 0.04;
/// Ranges of two neighbours that differ by less, metres, are one echo heard by both: two echoes of one thing differ
/// by the error of a range, twenty times as much.
const ONE_ECHO_M: f64 = 0.001;
/// Points that stand for the arc an echo can have come from: its ends and its middle.
const ARC: [f64; 3] = [-HALF_CONE, 0.0, HALF_CONE];

/// What one sonar heard: perhaps a person, somewhere on an arc.
#[derive(Clone, Copy)]
struct Mark {
    /// Points of the floor that the person's middle may have been at.
    arc: [Spot; 3],
    /// When it was heard.
    at: Time,
    /// How fast it may have walked by then, m/s.
    walking: f64,
}

/// The newest mark of each sonar, then older ones that may still hold.
type Marks = [[Option<Mark>; SONARS]; 2];

// A module is in one state at a time; boxing the large one would save nothing and allocate in a step.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy)]
enum State {
    Blind,
    Watching { marks: Marks, at: Time },
}

struct Collide {
    state: State,
    /// Pose and time of the beat before, and the speed since, m/s.
    before: Option<(Pose, Time)>,
    speed: f64,
    radius: f64,
    braking: f64,
    pace: f64,
    start: f64,
    margin: f64,
    latency: Span,
    lost: Span,
    blind: Span,
}

impl Collide {
    fn new(settings: &Settings<'_>) -> Collide {
        Collide {
            state: State::Blind,
            radius: settings.number("radius"),
            before: None,
            speed: 0.0,
            braking: settings.number("braking").max(0.01),
            pace: settings.number("pace"),
            start: settings.number("start").max(0.01),
            margin: settings.number("margin"),
            latency: settings.span("latency"),
            lost: settings.span("lost"),
            blind: settings.span("blind"),
        }
    }

    /// The marks of a map heard `at` a pose, given those of the map before.
    fn marks(&self, map: &Map, pose: Pose, at: Time, before: &Marks) -> Marks {
        let old = || before.iter().flatten().flatten();
        let newest = std::array::from_fn(|index| {
            let range = map.ranges[index];
            (range < FAR_M).then(|| {
                let range = if range < TOUCHING_M { 0.0 } else { range };
                let middle = self.radius + range + PERSON_M;
                let arc = ARC.map(|off| Spot::from(pose, middle, bearing(index) + off));
                let same = old().filter(|old| same_place(&old.arc, &arc));
                // Who comes nearer has started; who goes away has to start anew.
                let came = |old: &Mark| away(&old.arc, pose) - away(&arc, pose);
                let walking = same.map(|old| self.started(came(old))).fold(self.pace, f64::min);
                Mark { arc, at, walking }
            })
        });
        // An echo that was near a second ago and now is none was lost: the older one stands for it. It may have been
        // lost as well where a neighbour's is heard instead; that is rare, and not believed of two maps in a row.
        let held = std::array::from_fn(|index| {
            let known = match map.ranges[index] {
                range if range > NO_ECHO_M => &before[..],
                _ if is_a_neighbours(&map.ranges, index) => &before[..1],
                _ => return None,
            };
            let same_way = |mark: &&Mark| {
                let seen = mark.arc[1].seen_from(pose);
                let off = wrap(libm::atan2(seen.y, seen.x) - bearing(index));
                off.abs() <= HALF_CONE
            };
            let young = |mark: &&Mark| at.since(mark.at) < self.lost;
            let mut known = known.iter().flatten().flatten().filter(young);
            known.find(same_way).copied()
        });
        [newest, held]
    }

    /// Takes in where the wheels think they are, and with it how fast the robot is.
    fn follow(&mut self, pose: Pose, now: Time) {
        if let Some((was, at)) = self.before {
            let seconds = now.since(at).seconds();
            if seconds <= 0.0 {
                return;
            }
            let speed = libm::hypot(pose.x - was.x, pose.y - was.y) / seconds;
            self.speed += (speed - self.speed) * (FOLLOW * seconds).min(1.0);
        }
        self.before = Some((pose, now));
    }

    /// How fast somebody walks, m/s, who began to and `came` so many metres.
    fn started(&self, came: f64) -> f64 {
        let way = (came - STILL_M).max(0.0);
        libm::sqrt(2.0 * self.start * way).min(self.pace)
    }

    /// How far somebody comes in `seconds`, metres, who walked at `walking` m/s when the time began.
    fn walked(&self, seconds: f64, walking: f64) -> f64 {
        let starting = (self.pace - walking) / self.start;
        if seconds < starting {
            (walking + self.start * seconds / 2.0) * seconds
        } else {
            self.pace * seconds - (self.pace - walking) * starting / 2.0
        }
    }

    /// Whether the way ahead is barred at `now` for a robot at `pose`.
    fn barred(&self, marks: &Marks, pose: Pose, now: Time) -> bool {
        let speed = self.speed + SPEED_OFF_M_S;
        let stop = self.latency.seconds() + speed / self.braking;
        // Braking takes the robot half as far as it would have gone.
        let way = speed * (self.latency.seconds() + speed / self.braking / 2.0);
        let meet = self.radius + PERSON_M + self.margin;
        let (cos, sin) = (libm::cos(pose.heading), libm::sin(pose.heading));
        marks.iter().flatten().flatten().any(|mark| {
            let walked = self.walked(now.since(mark.at).seconds() + stop, mark.walking);
            let reaches = |spot: &Spot| {
                let (dx, dy) = (spot.x - pose.x, spot.y - pose.y);
                to_front(dx * cos + dy * sin - way, dy * cos - dx * sin, meet) < walked
            };
            mark.arc.iter().any(reaches)
        })
    }
}

/// Whether what the `index`-th sonar heard may be a neighbour's echo (cross-talk: Borenstein and Koren, "Error
/// eliminating rapid ultrasonic firing for mobile robot obstacle avoidance", 1995). What touches reads the same
/// everywhere, and nothing can be nearer.
fn is_a_neighbours(ranges: &[f64; SONARS], index: usize) -> bool {
    let neighbours = [index + 1, index + SONARS - 1].map(|i| ranges[i % SONARS]);
    let same = |range: &f64| (range - ranges[index]).abs() < ONE_ECHO_M;
    ranges[index] > TOUCHING_M && neighbours.iter().any(same)
}

/// Whether two arcs are of one place, as near as sonar can tell. Their ends don't count: who walks past the
/// robot leaves one cone where the next begins.
fn same_place(a: &[Spot; 3], b: &[Spot; 3]) -> bool {
    libm::hypot(a[1].x - b[1].x, a[1].y - b[1].y) < SAME_M
}

/// How far from `pose` an arc is, metres.
fn away(arc: &[Spot; 3], pose: Pose) -> f64 {
    libm::hypot(arc[1].x - pose.x, arc[1].y - pose.y)
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
        self.follow(pose, beat.stamp(POSE).unwrap_or(now));
        if let Some(map) = beat.arrived(MAP) {
            let at = beat.stamp(MAP).unwrap_or(now);
            let before = match self.state {
                State::Watching { marks, .. } => marks,
                State::Blind => Marks::default(),
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
        (self.before, self.speed) = (None, 0.0);
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Blind => "blind",
            State::Watching { .. } => "watching",
        }
    }
}
