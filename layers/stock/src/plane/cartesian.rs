//! `cartesian`: a vector from length and bearing.
//!
//! ```text
//!  out := (length*cos(bearing), length*sin(bearing))          emitted when in arrives
//! ```
//! In the unit of the length; x is forward, y to the left.
use afsm::ModuleKind;
use ipc::message::{Kind, Polar, Vector};
use ipc::wiring::Declaration;

use crate::declare::{input, out};
use crate::single::Single;

const ABOUT: &str = "turns length and bearing into x and y";
const DIAGRAM: &str = "out := (length*cos(bearing), length*sin(bearing)), when in arrives";

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "cartesian",
        about: ABOUT,
        diagram: DIAGRAM,
        inputs: &[input(Kind::Polar, "length and bearing (rad)")],
        outputs: &[out(Kind::Vector, "x forward, y to the left")],
        parameters: &[],
    },
    build: |_| {
        Box::new(Single::new(|p: Polar| Vector {
            x: p.length * libm::cos(p.bearing),
            y: p.length * libm::sin(p.bearing),
        }))
    },
}];
