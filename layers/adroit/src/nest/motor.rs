//! The five motor control units: what each does in a beat until it has done what it was called for.
//!
//! | unit | goal | ends |
//! | --- | --- | --- |
//! | move | a point, and a length to drive (negative: backwards) | length driven, or turned towards the point |
//! | steer | a point | wheel set for the point |
//! | arm | a point in reach, or no goal: stowed | hand there, after [`HOLD_S`] at least |
//! | grasp | an object at the hand | closed around it |
//! | release | none | hand open |

use serde::Serialize;

use super::geometry::{Point, between_rad};
use super::robot::{ARM_M, METRES_ON_A_TANK, Robot, SPEED_M_S, STOWED_M, WHEELBASE_M};
use super::world::{BEAT_S, World};
use crate::hierarchy::{Goal, McuId};

/// Turn of the steering wheel, radians a second.
pub(super) const STEERING_RAD_S: f64 = 3.0;
/// Above this deviation the robot turns on the spot, radians.
const ON_THE_SPOT_RAD: f64 = 0.15;
/// The wheel is on course within this, radians.
pub(super) const ON_COURSE_RAD: f64 = 0.02;
/// Arm turning, radians a second, and growing, metres a second.
pub(super) const ARM_RAD_S: f64 = 2.0;
pub(super) const ARM_M_S: f64 = 0.6;
/// Shortest time of an arm movement, seconds.
pub(super) const HOLD_S: f64 = 0.5;
/// Closing and opening the hand, seconds.
pub(super) const HAND_S: f64 = 0.4;
/// With the wheel set wider than this the robot turns on the spot, radians.
pub(super) const ON_THE_SPOT_STEERING_RAD: f64 = 1.5;
/// The hand takes what is this near, metres.
pub(crate) const HAND_M: f64 = 0.06;

/// The motor control units of the source's robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Unit {
    /// Move by rotating the drive wheels.
    Move,
    /// Change the direction of the steering wheel.
    Steer,
    /// Move the arm.
    Arm,
    /// Grasp with the hand.
    Grasp,
    /// Release from the hand.
    Release,
}

impl Unit {
    /// All units in the order of their numbers.
    pub const ALL: [Self; 5] = [Self::Move, Self::Steer, Self::Arm, Self::Grasp, Self::Release];

    /// The name in programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::Steer => "steer",
            Self::Arm => "arm",
            Self::Grasp => "grasp",
            Self::Release => "release",
        }
    }
}

/// A unit at work.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Working {
    pub(crate) mcu: McuId,
    pub(crate) goal: Goal,
    pub(crate) since_s: f64,
    pub(crate) driven_m: f64,
}

/// The steering that brings the robot towards a point, radians.
pub(crate) fn steering_for(robot: &Robot, to: Point) -> f64 {
    let off_rad = between_rad(robot.heading_rad, robot.place.direction_rad(to));
    if off_rad.abs() > ON_THE_SPOT_RAD {
        return core::f64::consts::FRAC_PI_2.copysign(off_rad);
    }
    let ahead_m = robot.place.distance_m(to).max(0.3);
    libm::atan2(2.0 * WHEELBASE_M * libm::sin(off_rad), ahead_m)
}

/// Whether the steering wheel stands as a point demands.
pub(crate) fn on_course(robot: &Robot, to: Point) -> bool {
    (robot.steering_rad - steering_for(robot, to)).abs() < ON_COURSE_RAD
}

/// One step of a quantity towards another.
pub(super) fn approach(from: f64, to: f64, step: f64) -> f64 {
    if (to - from).abs() <= step {
        to
    } else {
        from + step.copysign(to - from)
    }
}

impl World {
    /// One beat of a unit; tells when it ended, and whether it did what it was called for.
    pub(crate) fn work(&mut self, working: &mut Working) -> Option<bool> {
        let to = Point::new(working.goal.x_m, working.goal.y_m);
        match Unit::ALL[usize::from(working.mcu.0)] {
            Unit::Move => self.drive(working, to),
            Unit::Steer => {
                let wanted = steering_for(&self.robot, to);
                self.robot.steering_rad = approach(self.robot.steering_rad, wanted, STEERING_RAD_S * BEAT_S);
                (self.robot.steering_rad == wanted).then_some(true)
            }
            Unit::Arm => self.reach(working, to),
            Unit::Grasp => self.after_hand(working).map(|()| {
                let hand = self.robot.hand();
                let near =
                    |id: u32, place: Point| id == working.goal.thing && place.distance_m(hand) <= HAND_M;
                let found = self
                    .objects
                    .iter()
                    .find(|object| near(object.id, object.place))
                    .map(|object| object.id);
                self.robot.held = self.robot.held.or(found);
                found.is_some()
            }),
            Unit::Release => self
                .after_hand(working)
                .map(|()| self.robot.held.take().is_some()),
        }
    }

    fn after_hand(&self, working: &Working) -> Option<()> {
        (self.now_s >= working.since_s + HAND_S).then_some(())
    }

    fn drive(&mut self, working: &mut Working, to: Point) -> Option<bool> {
        if self.robot.fuel <= 0.0 {
            return Some(false);
        }
        let robot = &self.robot;
        let wheel_m = (SPEED_M_S * BEAT_S).copysign(working.goal.value);
        let on_the_spot = robot.steering_rad.abs() > ON_THE_SPOT_STEERING_RAD;
        let turn_rad = wheel_m * libm::sin(robot.steering_rad) / WHEELBASE_M;
        let off_rad = between_rad(robot.heading_rad, robot.place.direction_rad(to));
        let ends = if on_the_spot {
            off_rad.abs() <= turn_rad.abs()
        } else {
            working.driven_m + wheel_m.abs() >= working.goal.value.abs()
        };
        let turn_rad = if on_the_spot && ends { off_rad } else { turn_rad };
        let heading_rad = between_rad(0.0, robot.heading_rad + turn_rad);
        let forward_m = if on_the_spot {
            0.0
        } else {
            wheel_m * libm::cos(robot.steering_rad)
        };
        let place = robot.place.towards(robot.heading_rad + turn_rad / 2.0, forward_m);
        self.burn(wheel_m.abs() / METRES_ON_A_TANK);
        working.driven_m += wheel_m.abs();
        if forward_m != 0.0 && !self.move_robot(place) {
            self.robot.bumped = true;
            self.bumps += 1;
            return Some(false);
        }
        if forward_m < 0.0 && ends {
            self.robot.bumped = false;
        }
        self.robot.heading_rad = heading_rad;
        ends.then_some(true)
    }

    fn reach(&mut self, working: &Working, to: Point) -> Option<bool> {
        let robot = &mut self.robot;
        let (wanted_rad, wanted_m) = if working.goal == Goal::NONE {
            (0.0, STOWED_M)
        } else {
            (
                between_rad(robot.heading_rad, robot.place.direction_rad(to)),
                robot.place.distance_m(to),
            )
        };
        if wanted_m > ARM_M {
            return Some(false);
        }
        robot.arm_rad = approach(robot.arm_rad, wanted_rad, ARM_RAD_S * BEAT_S);
        robot.arm_m = approach(robot.arm_m, wanted_m, ARM_M_S * BEAT_S);
        let there = robot.arm_rad == wanted_rad && robot.arm_m == wanted_m;
        (there && self.now_s >= working.since_s + HOLD_S).then_some(true)
    }
}
