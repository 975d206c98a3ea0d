//! `compare`: how two numbers stand to each other.
//!
//! ```text
//!  equal: |a - b| ≤ tolerance     less: a < b and not equal     greater: a > b and not equal
//!  at-most, at-least, different: the opposites of greater, less and equal
//! ```
//! Emits when `a` or `b` arrives and both were ever received. In one unit.

use afsm::{ModuleKind, Settings};
use ipc::wiring::{Declaration, Parameter, Takes};

use crate::declare::positive;
use crate::pair::{Pair, PairPorts};

const WORDS: &[&str] = &["less", "at-most", "equal", "at-least", "greater", "different"];

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "compare",
        about: "whether a is less than b, or equal, or greater",
        diagram: "equal: |a - b| <= tolerance; less: a < b and not equal; greater: a > b and not equal\n\
            at-most, at-least, different: the opposites of greater, less and equal\n\
            out := whether a is so, when a or b arrives and both were ever received",
        inputs: PairPorts::<f64, bool>::INPUTS,
        outputs: PairPorts::<f64, bool>::OUTPUTS,
        parameters: &[
            Parameter::new(
                "is",
                Takes::Word {
                    words: WORDS,
                    default: None,
                },
                "what to ask of a, compared with b",
            ),
            positive(
                "tolerance",
                0.0,
                "[a]",
                "what they may differ by and count as equal",
            ),
        ],
    },
    build: |s| {
        let (asked, tolerance) = (asked(s), s.number("tolerance"));
        Box::new(Pair::new(move |a: f64, b: f64| asked.of(a, b, tolerance)))
    },
}];

/// Which of less, equal and greater are answered with true.
#[derive(Clone, Copy)]
struct Asked {
    less: bool,
    equal: bool,
    greater: bool,
}

fn asked(settings: &Settings<'_>) -> Asked {
    let word = settings.word("is");
    Asked {
        less: ["less", "at-most", "different"].contains(&word),
        equal: ["equal", "at-most", "at-least"].contains(&word),
        greater: ["greater", "at-least", "different"].contains(&word),
    }
}

impl Asked {
    fn of(self, a: f64, b: f64, tolerance: f64) -> bool {
        if (a - b).abs() <= tolerance {
            self.equal
        } else if a < b {
            self.less
        } else {
            self.greater
        }
    }
}
