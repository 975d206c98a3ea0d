//! The programs that the kinds of modules come with.

use adroit::language::{Running, Vocabulary};
use adroit::{drives, nest};

/// A program with the primitives of the robot it was written for.
pub(crate) struct BuiltIn {
    /// The kind of module that runs it.
    kind: &'static str,
    program: &'static str,
    vocabulary: fn() -> Vocabulary,
}

/// Of `mechanisms.drives`.
pub(crate) static DRIVES: BuiltIn = BuiltIn {
    kind: "mechanisms.drives",
    program: drives::PROGRAM,
    vocabulary: drives::vocabulary,
};

/// Of `mechanisms.nest`.
pub(crate) static NEST: BuiltIn = BuiltIn {
    kind: "mechanisms.nest",
    program: nest::PROGRAM,
    vocabulary: nest::vocabulary,
};

/// What a kind of module comes with, if it is one of this crate.
pub(crate) fn built_in(kind: &str) -> Option<&'static BuiltIn> {
    [&DRIVES, &NEST]
        .into_iter()
        .find(|built_in| built_in.kind == kind)
}

impl BuiltIn {
    /// The program, loaded.
    pub(crate) fn running(&self) -> Running {
        Running::load(self.program, (self.vocabulary)()).expect("the programs are tested")
    }
}
