//! `offset`: a number and a constant.
//!
//! ```text
//!  out := in + by          emitted when in arrives
//! ```
//! In the unit of `in`. A sum that is too large to be a number is not emitted.
use afsm::ModuleKind;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter};

use crate::declare::{input, number, out};
use crate::single::Single;

const ABOUT: &str = "adds a constant";
const DIAGRAM: &str = "out := in + by, when in arrives";
const PARAMETERS: &[Parameter] = &[number("by", 0.0, "[in]", "what to add")];

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "offset",
        about: ABOUT,
        diagram: DIAGRAM,
        inputs: &[input(Kind::Number, "what to add to")],
        outputs: &[out(Kind::Number, "the sum")],
        parameters: PARAMETERS,
    },
    build: |s| {
        let by = s.number("by");
        Box::new(Single::new(move |x: f64| x + by))
    },
}];
