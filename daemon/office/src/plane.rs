//! Vectors and angles in the plane, with `libm` beneath, so that every machine finds the same bits.

use core::f64::consts::{PI, TAU};
use core::ops::{Add, Mul, Sub};

/// A point or a direction, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vec2 {
    pub(crate) x: f64,
    pub(crate) y: f64,
}

pub(crate) const fn vec2(x: f64, y: f64) -> Vec2 {
    Vec2 { x, y }
}

impl Vec2 {
    /// The unit vector at `angle`, rad counter-clockwise from the x axis.
    pub(crate) fn at_angle(angle: f64) -> Vec2 {
        vec2(libm::cos(angle), libm::sin(angle))
    }

    pub(crate) fn dot(self, other: Vec2) -> f64 {
        self.x * other.x + self.y * other.y
    }

    pub(crate) fn length(self) -> f64 {
        libm::sqrt(self.dot(self))
    }

    /// This direction with length 1; zero stays zero.
    pub(crate) fn unit(self) -> Vec2 {
        let length = self.length();
        if length > 1e-12 {
            self * (1.0 / length)
        } else {
            Vec2::default()
        }
    }

    /// Turned left by a right angle.
    pub(crate) fn left(self) -> Vec2 {
        vec2(-self.y, self.x)
    }

    /// rad, counter-clockwise from the x axis.
    pub(crate) fn angle(self) -> f64 {
        libm::atan2(self.y, self.x)
    }
}

impl Add for Vec2 {
    type Output = Vec2;
    fn add(self, other: Vec2) -> Vec2 {
        vec2(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Vec2 {
    type Output = Vec2;
    fn sub(self, other: Vec2) -> Vec2 {
        vec2(self.x - other.x, self.y - other.y)
    }
}

impl Mul<f64> for Vec2 {
    type Output = Vec2;
    fn mul(self, factor: f64) -> Vec2 {
        vec2(self.x * factor, self.y * factor)
    }
}

/// The same angle in (-π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle - TAU * libm::floor(angle / TAU);
    if turned > PI { turned - TAU } else { turned }
}
