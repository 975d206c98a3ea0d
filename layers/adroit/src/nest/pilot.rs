//! The pilot: the robot's hierarchy between its sensors and its actuators, for a layer that knows only wires.
//!
//! ```text
//!   sensed ─► belief ─► evaluate, if an MCU ended or an interrupt is due ─► MCUs at work ─► setpoints
//! ```
//! Must never: allocate after it was made, plan (a search allocates), or see the world.

use super::geometry::{Point, between_rad};
use super::motor::{HAND_S, HOLD_S, ON_COURSE_RAD, ON_THE_SPOT_STEERING_RAD, Unit, Working, steering_for};
use super::robot::{ARM_M, SPEED_M_S, STOWED_M, WHEELBASE_M};
use super::run::called;
use super::wired::{Sensed, Setpoints};
use super::world::World;
use crate::hierarchy::{Goal, Hierarchy, OUTPUTS_MAX};

/// Within this time of its end a movement slows down, seconds: twice what a message and a beat take.
const SLOWING_S: f64 = 0.15;
/// Slowest that the wheel turns, metres a second.
const CRAWL_M_S: f64 = 0.04;
/// A movement is over when this much is left, metres.
const LEFT_M: f64 = 0.004;
/// An arm is there within this, metres and radians.
const ARM_THERE: f64 = 0.002;
/// A unit that has not ended after this long has failed, seconds: the longest movement takes less than three.
const UNIT_S: f64 = 8.0;
/// A wheel that does not roll for this long against something has failed, seconds.
const STUCK_S: f64 = 0.3;

/// The robot's hierarchy behind wires.
#[derive(Clone, Debug)]
pub struct Pilot {
    belief: World,
    working: [Option<Working>; OUTPUTS_MAX],
    ended: bool,
    setpoints: Setpoints,
    rolled_m: f64,
}

impl Pilot {
    /// A pilot that shall build a nest of `wanted` objects.
    #[must_use]
    pub fn new(wanted: usize) -> Self {
        Self {
            belief: World::belief(wanted),
            working: [None; OUTPUTS_MAX],
            ended: true,
            setpoints: Setpoints::STILL,
            rolled_m: 0.0,
        }
    }

    /// Forgets everything; keeps its room.
    pub fn forget(&mut self) {
        self.belief.forget_all();
        self.working = [None; OUTPUTS_MAX];
        self.ended = true;
        self.setpoints = Setpoints::STILL;
        self.rolled_m = 0.0;
    }

    /// What the robot believes.
    #[must_use]
    pub fn belief(&self) -> &World {
        &self.belief
    }

    /// Takes in what is sensed, and says how the actuators shall be. Tells whether there was an evaluation.
    pub fn step(&mut self, hierarchy: &mut Hierarchy, sensed: &Sensed) -> (Setpoints, bool) {
        self.belief.believe(sensed);
        let driven_m = (sensed.rolled_m - self.rolled_m).max(0.0);
        self.rolled_m = sensed.rolled_m;
        self.setpoints.wheel_m_s = 0.0;
        self.work(hierarchy, driven_m);
        let evaluates = self.ended || self.belief.interrupt;
        if evaluates {
            self.belief.interrupt = false;
            self.ended = false;
            self.setpoints.wheel_m_s = 0.0;
            hierarchy.evaluate(&self.belief);
            self.working = called(&self.working, hierarchy.outputs(), self.belief.now_s);
            self.belief.note_search(hierarchy);
            // What a unit is called for it begins at once.
            self.work(hierarchy, 0.0);
        }
        (self.setpoints, evaluates)
    }

    /// Lets the units work; one that has ended, or failed, is over.
    fn work(&mut self, hierarchy: &mut Hierarchy, driven_m: f64) {
        for slot in 0..OUTPUTS_MAX {
            let Some(mut unit) = self.working[slot] else {
                continue;
            };
            unit.driven_m += driven_m;
            let over = self.belief.now_s > unit.since_s + UNIT_S;
            let ended = self.unit(&unit).or(over.then_some(false));
            self.working[slot] = ended.is_none().then_some(unit);
            if let Some(succeeded) = ended {
                self.ended = true;
                if !succeeded {
                    hierarchy.report_failure(unit.mcu);
                }
            }
        }
        self.ended |= self.working.iter().all(Option::is_none);
    }

    fn unit(&mut self, working: &Working) -> Option<bool> {
        let to = Point::new(working.goal.x_m, working.goal.y_m);
        let robot = &self.belief.robot;
        let since_s = self.belief.now_s - working.since_s;
        match Unit::ALL[usize::from(working.mcu.0)] {
            Unit::Move => self.roll(working, to),
            Unit::Steer => {
                let wanted = steering_for(robot, to);
                self.setpoints.steering_rad = wanted;
                ((robot.steering_rad - wanted).abs() < ON_COURSE_RAD / 2.0).then_some(true)
            }
            Unit::Arm => {
                let (wanted_rad, wanted_m) = if working.goal == Goal::NONE {
                    (0.0, STOWED_M)
                } else {
                    let direction_rad = robot.place.direction_rad(to);
                    (
                        between_rad(robot.heading_rad, direction_rad),
                        robot.place.distance_m(to),
                    )
                };
                if wanted_m > ARM_M {
                    return Some(false);
                }
                (self.setpoints.arm_rad, self.setpoints.arm_m) = (wanted_rad, wanted_m);
                let there = (robot.arm_rad - wanted_rad).abs() < ARM_THERE
                    && (robot.arm_m - wanted_m.max(STOWED_M / 2.0)).abs() < ARM_THERE;
                (there && since_s >= HOLD_S).then_some(true)
            }
            Unit::Grasp => {
                self.setpoints.hold = working.goal.thing;
                let holds = robot.held == Some(working.goal.thing);
                if !holds && since_s > 3.0 * HAND_S {
                    self.setpoints.hold = robot.held.unwrap_or(0);
                    return Some(false);
                }
                holds.then_some(true)
            }
            Unit::Release => {
                self.setpoints.hold = 0;
                robot.held.is_none().then_some(true)
            }
        }
    }

    /// Drives the wheel as long as there is way left, or turning on the spot something left to turn.
    fn roll(&mut self, working: &Working, to: Point) -> Option<bool> {
        let robot = &mut self.belief.robot;
        if robot.fuel <= 0.0 {
            return Some(false);
        }
        let backwards = working.goal.value < 0.0;
        let left_m = if robot.steering_rad.abs() > ON_THE_SPOT_STEERING_RAD {
            let off_rad = between_rad(robot.heading_rad, robot.place.direction_rad(to));
            off_rad * robot.steering_rad.signum() * WHEELBASE_M
        } else {
            working.goal.value.abs() - working.driven_m
        };
        if left_m <= LEFT_M {
            robot.bumped &= !backwards;
            return Some(true);
        }
        let since_s = self.belief.now_s - working.since_s;
        if self.belief.robot.bumped && !backwards {
            return Some(false);
        }
        if backwards && since_s > STUCK_S && working.driven_m == 0.0 {
            // Neither forward nor back: whatever is behind may have moved by the next evaluation.
            self.belief.robot.bumped = false;
            return Some(false);
        }
        let speed_m_s = (left_m / SLOWING_S).clamp(CRAWL_M_S, SPEED_M_S);
        self.setpoints.wheel_m_s = speed_m_s.copysign(working.goal.value);
        None
    }
}
