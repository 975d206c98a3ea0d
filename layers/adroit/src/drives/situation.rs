//! The situation of a robot with a ring of sonars, and the primitives that a program may name.
//!
//! Must never: allocate, or keep a map. What it remembers is how tired it is and that it was thwarted.

use crate::hierarchy::{CriterionId, Goal, Senses, StateId, StimulusId};
use crate::language::Vocabulary;
use crate::nest::{Point, between_rad};

use super::Unit;

/// Sonars around the robot.
pub const RANGES: usize = 12;
/// A place is reached within this, metres.
const THERE_M: f64 = 0.6;
/// A far place lies this far before what the sonar heard, metres.
const BEFORE_M: f64 = 0.8;
/// No nearer place is worth setting out for, metres.
const FAR_LEAST_M: f64 = 1.2;
/// Nor is any farther one: what is heard from afar is heard badly, metres.
const FAR_MOST_M: f64 = 5.0;
/// Nothing farther than this crowds the robot, metres.
const CROWDING_M: f64 = 1.5;
/// In the open nothing is nearer than this, metres.
const OPEN_M: f64 = 1.0;
/// How far ahead the open is looked for, metres.
const OUT_M: f64 = 1.5;
/// Share of a range that counts when it lies straight behind: the robot has just come from there.
const BEHIND: f64 = 0.4;
/// A turn of the situation by this much is a priority interrupt.
const SUDDEN: f64 = 0.2;
/// How long a robot feels thwarted, seconds.
const THWARTED_S: f64 = 15.0;
/// Slower than this the robot stands, metres a second.
const STANDING_M_S: f64 = 0.02;

const STIMULI: [&str; 5] = ["tired", "resting", "crowded", "way-open", "thwarted"];
const CRITERIA: [&str; 2] = ["far-place", "open-space"];
const STATES: [&str; 3] = ["at-goal", "in-open", "rested"];

/// The vocabulary of this robot.
#[must_use]
pub fn vocabulary() -> Vocabulary {
    Vocabulary::new(&STIMULI, &CRITERIA, &STATES, &Unit::ALL.map(Unit::name))
}

/// How long the robot lasts, and how fast it recovers.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Driving for this long tires it out, seconds.
    pub stamina_s: f64,
    /// Standing still for this long, resting, recovers it wholly, seconds.
    pub recovery_s: f64,
}

/// What the sensor wires said last.
#[derive(Clone, Copy, Debug)]
pub struct Sensed {
    /// Time, seconds.
    pub now_s: f64,
    /// Where the wheels think they are, metres.
    pub place: Point,
    /// Which way they think the robot faces, radians.
    pub heading_rad: f64,
    /// What the ring heard, metres: straight ahead first, counter-clockwise.
    pub ranges_m: [f64; RANGES],
}

/// The situation as the hierarchy sees it.
#[derive(Clone, Debug)]
pub struct Situation {
    limits: Limits,
    sensed: Option<Sensed>,
    /// When it was last thwarted, seconds.
    thwarted_s: Option<f64>,
    tired: f64,
    pub(super) resting: bool,
}

/// Bearing of a sonar, radians from straight ahead, from -pi to pi.
fn bearing_rad(sonar: usize) -> f64 {
    between_rad(0.0, sonar as f64 * core::f64::consts::TAU / RANGES as f64)
}

impl Situation {
    pub(super) fn new(limits: Limits) -> Self {
        Self {
            limits,
            sensed: None,
            thwarted_s: None,
            tired: 0.0,
            resting: false,
        }
    }

    /// How tired it is, from 0 to 1.
    #[must_use]
    pub fn tired(&self) -> f64 {
        self.tired
    }

    pub(super) fn now_s(&self) -> f64 {
        self.sensed.map_or(0.0, |sensed| sensed.now_s)
    }

    pub(super) fn place(&self) -> Point {
        self.sensed.map_or(Point::default(), |sensed| sensed.place)
    }

    pub(super) fn bearing_rad(&self, goal: Point) -> f64 {
        self.sensed.map_or(0.0, |sensed| {
            between_rad(sensed.heading_rad, sensed.place.direction_rad(goal))
        })
    }

    pub(super) fn thwart(&mut self) {
        self.thwarted_s = Some(self.now_s());
    }

    pub(super) fn sense(&mut self, sensed: &Sensed) -> bool {
        let crowded = self.crowded();
        if let Some(before) = self.sensed {
            let passed_s = (sensed.now_s - before.now_s).max(0.0);
            let moved = before.place.distance_m(sensed.place) > STANDING_M_S * passed_s;
            // A pause on the way is no rest: the robot turns on the spot, or waits for a map.
            let change = match (moved, self.resting) {
                (true, _) => passed_s / self.limits.stamina_s,
                (false, true) => -passed_s / self.limits.recovery_s,
                (false, false) => 0.0,
            };
            self.tired = (self.tired + change).clamp(0.0, 1.0);
        }
        self.sensed = Some(*sensed);
        (self.crowded() - crowded).abs() >= SUDDEN
    }

    fn nearest_m(&self) -> f64 {
        let ranges = self.sensed.iter().flat_map(|sensed| sensed.ranges_m);
        ranges.fold(f64::INFINITY, f64::min)
    }

    fn crowded(&self) -> f64 {
        ((CROWDING_M - self.nearest_m()) / CROWDING_M).clamp(0.0, 1.0)
    }

    fn thwarted(&self) -> f64 {
        let since = self.thwarted_s.map(|at_s| self.now_s() - at_s);
        since.map_or(0.0, |since_s| (1.0 - since_s / THWARTED_S).clamp(0.0, 1.0))
    }

    /// The farthest place that the ring shows, rather ahead than behind; none when there is no room anywhere.
    fn far_place(&self) -> Option<(f64, Point)> {
        let sensed = self.sensed.as_ref()?;
        let mut best: Option<(f64, f64, f64)> = None;
        for (sonar, &range_m) in sensed.ranges_m.iter().enumerate() {
            let far_m = (range_m - BEFORE_M).min(FAR_MOST_M);
            let turn_rad = bearing_rad(sonar);
            let worth = far_m * (1.0 - (1.0 - BEHIND) * turn_rad.abs() / core::f64::consts::PI);
            if far_m >= FAR_LEAST_M && best.is_none_or(|(most, _, _)| worth > most) {
                best = Some((worth, far_m, turn_rad));
            }
        }
        let (_, far_m, turn_rad) = best?;
        Some((far_m, sensed.place.towards(sensed.heading_rad + turn_rad, far_m)))
    }

    /// A place away from what is near, by the inverse squares of the ranges; none where they balance.
    fn open_space(&self) -> Option<Point> {
        let sensed = self.sensed.as_ref()?;
        let (mut x, mut y) = (0.0, 0.0);
        for (sonar, &range_m) in sensed.ranges_m.iter().enumerate() {
            let push = 1.0 / range_m.max(0.1).powi(2);
            x -= push * libm::cos(bearing_rad(sonar));
            y -= push * libm::sin(bearing_rad(sonar));
        }
        (libm::hypot(x, y) > 0.1).then(|| {
            sensed
                .place
                .towards(sensed.heading_rad + libm::atan2(y, x), OUT_M)
        })
    }
}

fn goal_at(place: Point) -> Goal {
    Goal::at(place.x_m, place.y_m)
}

impl Senses for Situation {
    fn stimulus(&self, stimulus: StimulusId, _: &Goal) -> f64 {
        match STIMULI[usize::from(stimulus.0) - 1] {
            "tired" => self.tired,
            "resting" => f64::from(u8::from(self.resting)),
            "crowded" => self.crowded(),
            "way-open" => self.far_place().map_or(0.0, |(far_m, _)| far_m / FAR_MOST_M),
            "thwarted" => self.thwarted(),
            unknown => unreachable!("no stimulus {unknown}"),
        }
    }

    fn select(&self, criterion: CriterionId, _: &Goal) -> Option<Goal> {
        match CRITERIA[usize::from(criterion.0)] {
            "far-place" => self.far_place().map(|(_, place)| goal_at(place)),
            "open-space" => self.open_space().map(goal_at),
            unknown => unreachable!("no goal criterion {unknown}"),
        }
    }

    fn holds(&self, state: StateId, goal: &Goal) -> bool {
        match STATES[usize::from(state.0)] {
            "at-goal" => self.place().distance_m(Point::new(goal.x_m, goal.y_m)) < THERE_M,
            "in-open" => self.nearest_m() > OPEN_M,
            "rested" => self.tired < 0.1,
            unknown => unreachable!("no goal state {unknown}"),
        }
    }
}
