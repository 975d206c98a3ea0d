//! `polar`: length and bearing of a vector.
//!
//! ```text
//!  out := (hypot(x, y), atan2(y, x))          emitted when in arrives
//! ```
//! The bearing is in radians, counter-clockwise from straight ahead, from -pi to pi; that of the zero vector is 0.
//! A length that is too large to be a number is not emitted.
use afsm::ModuleKind;
use ipc::message::{Kind, Polar, Vector};
use ipc::wiring::Declaration;

use crate::declare::{input, out};
use crate::single::Single;

const ABOUT: &str = "turns x and y into length and bearing";
const DIAGRAM: &str = "out := (hypot(x, y), atan2(y, x)), when in arrives";

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "polar",
        about: ABOUT,
        diagram: DIAGRAM,
        inputs: &[input(Kind::Vector, "x forward, y to the left")],
        outputs: &[out(Kind::Polar, "length and bearing (rad)")],
        parameters: &[],
    },
    build: |_| {
        Box::new(Single::new(|v: Vector| Polar {
            length: libm::hypot(v.x, v.y),
            bearing: libm::atan2(v.y, v.x),
        }))
    },
}];
