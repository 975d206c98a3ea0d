//! `not`: the opposite of a bit.
//!
//! ```text
//!  out := not in          emitted when in arrives
//! ```
//! | in | out |
//! | -- | --- |
//! | 0 | 1 |
//! | 1 | 0 |
use afsm::ModuleKind;
use ipc::message::Kind;
use ipc::wiring::Declaration;

use crate::declare::{input, out};
use crate::single::Single;

const ABOUT: &str = "true when the bit is not";
const DIAGRAM: &str = "out := not in, when in arrives";

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "not",
        about: ABOUT,
        diagram: DIAGRAM,
        inputs: &[input(Kind::Bit, "a bit")],
        outputs: &[out(Kind::Bit, "its opposite")],
        parameters: &[],
    },
    build: |_| Box::new(Single::new(|bit: bool| !bit)),
}];
