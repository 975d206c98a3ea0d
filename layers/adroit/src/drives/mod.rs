//! Drives for a wandering robot with a ring of sonars: explore, rest, seek open space, or let level 1 be.
//!
//! Must never: decide what to do; that is written in `programs/drives.adroit`. Nor drive a wheel: what it
//! puts out is a heading, a hold, or nothing.
//!
//! ```text
//!   sonar map, odometry, compass ──► situation ──primitives──► hierarchy ──outputs──► heading, hold, silence
//! ```

mod situation;

pub use situation::{Limits, RANGES, Sensed, Situation, vocabulary};

use crate::hierarchy::{Hierarchy, McuId};
use crate::nest::Point;

/// The program, for whoever brings none of their own.
pub const PROGRAM: &str = include_str!("../../programs/drives.adroit");

/// A heading that brings the robot no nearer for this long has failed, seconds.
const HEADWAY_S: f64 = 20.0;
/// Nearer by this much is headway, metres.
const HEADWAY_M: f64 = 0.1;
/// A goal that moved by more than this is another one, metres.
const SAME_GOAL_M: f64 = 0.3;

/// The motor control units of this robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Gives level 1 a heading.
    Heading,
    /// Keeps level 1 from wandering.
    Hold,
    /// Says nothing.
    Silence,
}

impl Unit {
    /// All units in the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Heading, Self::Hold, Self::Silence];

    /// The name in programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Heading => "heading",
            Self::Hold => "hold",
            Self::Silence => "silence",
        }
    }

    fn of(mcu: McuId) -> Self {
        Self::ALL[usize::from(mcu.0)]
    }
}

/// What one evaluation came to: what to say below.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Said {
    /// Where to go, radians counter-clockwise from straight ahead.
    pub bearing_rad: Option<f64>,
    /// No wandering.
    pub hold: bool,
}

/// The heading at work: what it makes for, and how near it ever came.
#[derive(Clone, Copy, Debug)]
struct Pursuit {
    goal: Point,
    nearest_m: f64,
    nearer_s: f64,
}

/// The robot's drives: a situation and what follows from one evaluation to the next.
#[derive(Clone, Debug)]
pub struct Drives {
    situation: Situation,
    pursuit: Option<Pursuit>,
}

impl Drives {
    /// Drives of a robot that was just switched on and is not tired.
    #[must_use]
    pub fn new(limits: Limits) -> Self {
        Self {
            situation: Situation::new(limits),
            pursuit: None,
        }
    }

    /// The situation as it was sensed last.
    #[must_use]
    pub fn situation(&self) -> &Situation {
        &self.situation
    }

    /// Takes in what is sensed; tells whether it is a priority interrupt.
    pub fn sense(&mut self, sensed: &Sensed) -> bool {
        self.situation.sense(sensed)
    }

    /// Evaluates the hierarchy from the top and says what its units do until the next evaluation.
    pub fn decide(&mut self, hierarchy: &mut Hierarchy) -> Said {
        hierarchy.evaluate(&self.situation);
        let mut said = Said::default();
        let mut thwarted = None;
        let mut pursued = false;
        for output in hierarchy.outputs() {
            match Unit::of(output.mcu) {
                Unit::Silence => {}
                Unit::Hold => said.hold = true,
                Unit::Heading => {
                    let goal = Point::new(output.goal.x_m, output.goal.y_m);
                    pursued = true;
                    if self.headway(goal) {
                        said.bearing_rad = Some(self.situation.bearing_rad(goal));
                    } else {
                        thwarted = Some(output.mcu);
                    }
                }
            }
        }
        if !pursued {
            self.pursuit = None;
        }
        if let Some(mcu) = thwarted {
            // It climbs in the next evaluation; until then nothing is said.
            hierarchy.report_failure(mcu);
            self.situation.thwart();
            self.pursuit = None;
        }
        self.situation.resting = said.hold;
        said
    }

    /// Whether the robot still comes nearer to a goal, or has only just turned to it.
    fn headway(&mut self, goal: Point) -> bool {
        let (left_m, now_s) = (self.situation.place().distance_m(goal), self.situation.now_s());
        let fresh = Pursuit {
            goal,
            nearest_m: left_m,
            nearer_s: now_s,
        };
        let known = self.pursuit.filter(|p| p.goal.distance_m(goal) < SAME_GOAL_M);
        let mut pursuit = known.unwrap_or(fresh);
        if left_m < pursuit.nearest_m - HEADWAY_M {
            pursuit = Pursuit {
                goal: pursuit.goal,
                nearest_m: left_m,
                nearer_s: now_s,
            };
        }
        self.pursuit = Some(pursuit);
        now_s - pursuit.nearer_s < HEADWAY_S
    }
}
