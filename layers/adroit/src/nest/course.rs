//! The subgoals of go-to: the smallest deviation from the target's bearing that gets the robot past what is
//! in the way.
//!
//! An obstacle closes an interval of directions, wider the nearer it is. What the robot faces is the
//! obstacle that closes the target's bearing, and every other whose interval overlaps those found so far:
//! between overlapping ones there is no way through. One, two or more are handled by an RM each. A subgoal
//! is an edge of such an interval that no other closes and that does not lead off the floor. Source: *Goal
//! selection mechanism operation*.

use super::geometry::{Point, between_rad};
use super::robot::{ARM_M, CLEARANCE_M, RADIUS_M};
use super::world::{Disc, FLOOR_X_M, FLOOR_Y_M, World};
use crate::hierarchy::Goal;

/// Most obstacles considered at once; nearer ones come first in no world with fewer.
const FACED_MAX: usize = 16;
/// Longest drive of one MCU output, metres.
const STEP_M: f64 = 0.5;
/// A course must stay on the floor for this long, metres.
const AHEAD_M: f64 = 0.8;
/// An edge is passed by this much, radians, not to be closed itself.
const BESIDE_RAD: f64 = 0.01;
/// Weight of turning against deviation: of two nearly equal edges, the one more in front.
const TURNING: f64 = 0.15;
/// How far the robot backs off after it ran into something, metres.
const BACK_OFF_M: f64 = 0.3;

/// Directions closed by an obstacle: around a middle, to both sides, radians.
#[derive(Clone, Copy, Default)]
struct Closed {
    middle_rad: f64,
    side_rad: f64,
}

impl Closed {
    fn closes(&self, direction_rad: f64) -> bool {
        between_rad(self.middle_rad, direction_rad).abs() < self.side_rad
    }

    fn overlaps(&self, other: &Self) -> bool {
        between_rad(self.middle_rad, other.middle_rad).abs() < self.side_rad + other.side_rad
    }
}

/// What the robot faces on its way to a target.
pub(crate) struct Faced {
    closed: [Closed; FACED_MAX],
    count: usize,
}

impl Faced {
    /// How many obstacles have to be passed as one.
    pub(crate) fn count(&self) -> usize {
        self.count
    }
}

impl World {
    fn closed_by(&self, disc: &Disc) -> Closed {
        let distance_m = self.robot.place.distance_m(disc.place);
        let needed_m = disc.radius_m + RADIUS_M + CLEARANCE_M;
        let side_rad = if distance_m <= needed_m {
            core::f64::consts::FRAC_PI_2
        } else {
            libm::asin(needed_m / distance_m)
        };
        Closed {
            middle_rad: self.robot.place.direction_rad(disc.place),
            side_rad,
        }
    }

    /// Whether an obstacle is nearer than the target can be reached from.
    fn nearer(&self, disc: &Disc, target: Point) -> bool {
        let to_target_m = self.robot.place.distance_m(target);
        self.robot.place.distance_m(disc.place) - disc.radius_m - RADIUS_M < to_target_m - ARM_M / 2.0
    }

    /// What the robot faces on its way to a target, of what it sees.
    pub(crate) fn faces(&self, target: Point) -> Faced {
        let bearing_rad = self.robot.place.direction_rad(target);
        let mut faced = Faced {
            closed: [Closed::default(); FACED_MAX],
            count: 0,
        };
        let mut taken = [false; FACED_MAX];
        loop {
            let before = faced.count;
            for (place, (disc, _)) in self.seen.obstacles.iter().take(FACED_MAX).enumerate() {
                if taken[place] || !self.nearer(disc, target) {
                    continue;
                }
                let closed = self.closed_by(disc);
                let joins = if faced.count == 0 {
                    closed.closes(bearing_rad)
                } else {
                    faced.closed[..faced.count]
                        .iter()
                        .any(|other| other.overlaps(&closed))
                };
                if joins {
                    taken[place] = true;
                    faced.closed[faced.count] = closed;
                    faced.count += 1;
                }
            }
            if faced.count == before {
                return faced;
            }
        }
    }

    /// The course past what the robot faces; `None` when every edge is closed.
    pub(crate) fn pass(&self, given: &Goal) -> Option<Goal> {
        let target = Point::new(given.x_m, given.y_m);
        let robot = &self.robot;
        let bearing_rad = robot.place.direction_rad(target);
        let faced = self.faces(target);
        let closed = &faced.closed[..faced.count];
        let mut best: Option<(f64, f64)> = None;
        for one in closed {
            for side in [-1.0, 1.0] {
                let edge_rad = one.middle_rad + side * (one.side_rad + BESIDE_RAD);
                let ahead = robot.place.towards(edge_rad, AHEAD_M);
                let inside = |at: f64, size: f64| at > RADIUS_M && at < size - RADIUS_M;
                let on_floor = inside(ahead.x_m, FLOOR_X_M) && inside(ahead.y_m, FLOOR_Y_M);
                if !on_floor || closed.iter().any(|other| other.closes(edge_rad)) {
                    continue;
                }
                let cost = between_rad(bearing_rad, edge_rad).abs()
                    + TURNING * between_rad(robot.heading_rad, edge_rad).abs();
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, edge_rad));
                }
            }
        }
        best.map(|(_, edge_rad)| self.course(given, robot.place.towards(edge_rad, 2.0)))
    }

    /// The course straight to a point on the way to a target, as far as one MCU output goes.
    pub(crate) fn course(&self, target: &Goal, towards: Point) -> Goal {
        let left_m = self.robot.place.distance_m(Point::new(target.x_m, target.y_m)) - 0.8 * ARM_M;
        Goal {
            thing: target.thing,
            x_m: towards.x_m,
            y_m: towards.y_m,
            value: left_m.clamp(0.05, STEP_M),
        }
    }

    /// Back from what the robot ran into.
    pub(crate) fn backward(&self) -> Goal {
        let ahead = self.robot.place.towards(self.robot.heading_rad, 1.0);
        Goal {
            thing: 0,
            x_m: ahead.x_m,
            y_m: ahead.y_m,
            value: -BACK_OFF_M,
        }
    }
}
