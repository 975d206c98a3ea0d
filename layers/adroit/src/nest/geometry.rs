//! Points, directions and the circles of obstacles as a robot sees them.

use serde::Serialize;

/// A place on the floor, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// To the east.
    pub x_m: f64,
    /// To the north.
    pub y_m: f64,
}

impl Point {
    /// A place, metres.
    #[must_use]
    pub const fn new(x_m: f64, y_m: f64) -> Self {
        Self { x_m, y_m }
    }

    /// Distance to another place, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f64 {
        libm::hypot(other.x_m - self.x_m, other.y_m - self.y_m)
    }

    /// Direction to another place, radians from east, counter-clockwise.
    #[must_use]
    pub fn direction_rad(self, other: Self) -> f64 {
        libm::atan2(other.y_m - self.y_m, other.x_m - self.x_m)
    }

    /// The place so far in a direction.
    #[must_use]
    pub fn towards(self, direction_rad: f64, length_m: f64) -> Self {
        Self {
            x_m: self.x_m + length_m * libm::cos(direction_rad),
            y_m: self.y_m + length_m * libm::sin(direction_rad),
        }
    }
}

/// The turn from one direction to another, radians, from -pi to pi.
pub(crate) fn between_rad(from_rad: f64, to_rad: f64) -> f64 {
    let turn = libm::fmod(to_rad - from_rad, core::f64::consts::TAU);
    if turn > core::f64::consts::PI {
        turn - core::f64::consts::TAU
    } else if turn < -core::f64::consts::PI {
        turn + core::f64::consts::TAU
    } else {
        turn
    }
}

/// How near a place comes to the straight way between two others, metres.
pub(crate) fn distance_to_segment_m(place: Point, from: Point, to: Point) -> f64 {
    let (along_x, along_y) = (to.x_m - from.x_m, to.y_m - from.y_m);
    let squared = along_x * along_x + along_y * along_y;
    if squared == 0.0 {
        return place.distance_m(from);
    }
    let share = ((place.x_m - from.x_m) * along_x + (place.y_m - from.y_m) * along_y) / squared;
    let share = share.clamp(0.0, 1.0);
    place.distance_m(Point::new(from.x_m + share * along_x, from.y_m + share * along_y))
}
