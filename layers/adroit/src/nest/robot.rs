//! The robot: its body, its tank, and the little it remembers.

use serde::Serialize;

use super::geometry::Point;
use super::sweep::Sweep;
use crate::planning::Map;

/// Radius of the round body, metres.
pub const RADIUS_M: f64 = 0.25;
/// From the axle to the steering wheel, which is also the driven one, metres.
pub(crate) const WHEELBASE_M: f64 = 0.30;
/// Reach of the arm from the middle of the body, metres.
pub const ARM_M: f64 = 0.7;
/// Speed of the driven wheel, metres a second.
pub const SPEED_M_S: f64 = 0.5;
/// How far the eyes see, metres.
pub const EYES_RANGE_M: f64 = 4.5;
/// How far to either side the eyes see, radians.
pub const EYES_SIDE_RAD: f64 = 1.4;
/// Kept between the body and an obstacle when a course is chosen, metres.
pub const CLEARANCE_M: f64 = 0.12;
/// Wheel travel that a full tank allows, metres.
pub const METRES_ON_A_TANK: f64 = 120.0;
/// Part of the tank used in a second of standing still.
pub(crate) const IDLE_PER_S: f64 = 1.0 / 7200.0;
/// Part of the tank that a station fills in a second.
pub(crate) const FILLING_PER_S: f64 = 0.1;
/// How near to the middle of a station the hand must be for fuel to flow, metres.
pub(crate) const PUMP_M: f64 = 0.1;

/// The robot.
#[derive(Clone, Debug, Serialize)]
pub struct Robot {
    /// Middle of the body, over the axle.
    pub place: Point,
    /// Where it looks, radians from east.
    pub heading_rad: f64,
    /// Steering wheel against straight ahead, radians.
    pub steering_rad: f64,
    /// Direction of the arm against the heading, radians.
    pub arm_rad: f64,
    /// Length of the arm, metres.
    pub arm_m: f64,
    /// The object in the hand.
    pub held: Option<u32>,
    /// Fuel, from 0 to 1.
    pub fuel: f64,
    /// The latest move ran into something.
    pub bumped: bool,
    /// Fuel flows.
    pub filling: bool,
    /// The nest site it found.
    pub site: Option<u32>,
    /// Objects it saw at the site when it last looked.
    pub counted: usize,
    /// The search patterns, one for each thing looked for.
    #[serde(skip)]
    pub(crate) sweeps: Sweeps,
    /// Obstacles it has seen, for planning.
    #[serde(skip)]
    pub(crate) map: Map,
}

/// The search patterns, one for each thing looked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sweeps {
    pub(crate) site: Sweep,
    pub(crate) object: Sweep,
    pub(crate) station: Sweep,
}

impl Robot {
    /// A robot with a full tank and a stowed arm.
    #[must_use]
    pub fn new(place: Point, heading_rad: f64) -> Self {
        Self {
            place,
            heading_rad,
            steering_rad: 0.0,
            arm_rad: 0.0,
            arm_m: STOWED_M,
            held: None,
            fuel: 1.0,
            bumped: false,
            filling: false,
            site: None,
            counted: 0,
            sweeps: Sweeps::default(),
            map: Map::default(),
        }
    }

    /// Where the hand is.
    #[must_use]
    pub fn hand(&self) -> Point {
        self.place.towards(self.heading_rad + self.arm_rad, self.arm_m)
    }
}

/// Length of the stowed arm, metres.
pub(crate) const STOWED_M: f64 = 0.3;
