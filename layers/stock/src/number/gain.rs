//! `gain`: a message times a factor.
//!
//! ```text
//!  out := factor * in          emitted when in arrives
//! ```
//! In the unit of `in` times that of `factor`. A product that is too large to be a number is not emitted.
use afsm::ModuleKind;
use ipc::message::{Kind, Vector};
use ipc::wiring::{Declaration, Parameter};

use crate::declare::{input, number, out};
use crate::single::Single;

const ABOUT: &str = "multiplies by a factor";
const DIAGRAM: &str = "out := factor * in, when in arrives";
const PARAMETERS: &[Parameter] = &[number("factor", 1.0, "", "the factor, of either sign")];

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[
    &ModuleKind {
        declaration: &Declaration {
            name: "gain",
            about: ABOUT,
            diagram: DIAGRAM,
            inputs: &[input(Kind::Number, "what to multiply")],
            outputs: &[out(Kind::Number, "the product")],
            parameters: PARAMETERS,
        },
        build: |s| {
            let factor = s.number("factor");
            Box::new(Single::new(move |x: f64| factor * x))
        },
    },
    &ModuleKind {
        declaration: &Declaration {
            name: "gain.vector",
            about: ABOUT,
            diagram: DIAGRAM,
            inputs: &[input(Kind::Vector, "what to multiply")],
            outputs: &[out(Kind::Vector, "the product")],
            parameters: PARAMETERS,
        },
        build: |s| {
            let factor = s.number("factor");
            Box::new(Single::new(move |v: Vector| Vector {
                x: factor * v.x,
                y: factor * v.y,
            }))
        },
    },
];
