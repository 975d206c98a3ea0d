//! The simple computations that Allen's modules have access to (Brooks 1991 §6.2): angles and the sonar ring.

use core::f64::consts::{PI, TAU};

use ipc::message::SONARS;

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

#[cfg(test)]
mod tests {
    use super::*;

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
