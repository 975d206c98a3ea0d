//! `clamp`: a number kept between two bounds.
//!
//! ```text
//!  out := smaller of high and (larger of low and in)          emitted when in arrives
//! ```
//! In the unit of `in`. Should `low` lie above `high`, `high` is what comes out.
use afsm::ModuleKind;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter};

use crate::declare::{input, number, out};
use crate::single::Single;

const ABOUT: &str = "keeps a number between two bounds";
const DIAGRAM: &str = "out := smaller of high and (larger of low and in), when in arrives";
const PARAMETERS: &[Parameter] = &[
    number("low", -1.0, "[in]", "smallest that comes out"),
    number("high", 1.0, "[in]", "largest that comes out"),
];

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "clamp",
        about: ABOUT,
        diagram: DIAGRAM,
        inputs: &[input(Kind::Number, "any number")],
        outputs: &[out(Kind::Number, "the number, or the bound it crossed")],
        parameters: PARAMETERS,
    },
    build: |s| {
        let (low, high) = (s.number("low"), s.number("high"));
        Box::new(Single::new(move |x: f64| x.max(low).min(high)))
    },
}];
