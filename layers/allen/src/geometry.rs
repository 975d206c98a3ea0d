//! The simple computations that Allen's modules have access to (Brooks 1991 §6.2): angles and the sonar ring.

use core::f64::consts::{PI, TAU};

use ipc::message::{Pose, SONARS};

/// Bearing of the `index`-th sonar, radians counter-clockwise from straight ahead.
pub fn bearing(index: usize) -> f64 {
    wrap(index as f64 * TAU / SONARS as f64)
}

/// Half the width of a sonar's cone, radians.
pub const HALF_CONE: f64 = TAU / SONARS as f64 / 2.0;

/// The same angle between -π and π.
pub fn wrap(angle: f64) -> f64 {
    let turns = libm::floor((angle + PI) / TAU);
    angle - turns * TAU
}

/// A point: of the floor, or as seen from a robot, then x ahead and y to the left; metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
}

impl Spot {
    /// The point of the floor that a robot at `pose` sees `distance` away at `bearing`.
    pub fn from(pose: Pose, distance: f64, bearing: f64) -> Spot {
        Spot {
            x: pose.x + distance * libm::cos(pose.heading + bearing),
            y: pose.y + distance * libm::sin(pose.heading + bearing),
        }
    }

    /// How a robot at `pose` sees this point of the floor.
    pub fn seen_from(self, pose: Pose) -> Spot {
        let (dx, dy) = (self.x - pose.x, self.y - pose.y);
        let (cos, sin) = (libm::cos(pose.heading), libm::sin(pose.heading));
        Spot {
            x: dx * cos + dy * sin,
            y: dy * cos - dx * sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_is_seen_where_it_was_put() {
        let pose = Pose {
            x: 1.0,
            y: -2.0,
            heading: 2.5,
        };
        let seen = Spot::from(pose, 3.0, 0.5).seen_from(pose);
        assert!((seen.x - 3.0 * libm::cos(0.5)).abs() < 1e-12);
        assert!((seen.y - 3.0 * libm::sin(0.5)).abs() < 1e-12);
    }

    #[test]
    fn wrapped_angles_are_the_same_angles() {
        for k in -20..20 {
            let angle = f64::from(k) * 0.7;
            let wrapped = wrap(angle);
            assert!((-PI..=PI).contains(&wrapped));
            assert!(libm::fabs(libm::sin(angle) - libm::sin(wrapped)) < 1e-12);
        }
        assert_eq!(bearing(0), 0.0);
        assert!(
            (bearing(9) + PI / 2.0).abs() < 1e-12,
            "the tenth sonar points to the right"
        );
    }
}
