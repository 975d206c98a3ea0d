//! The hierarchy assembly language: text in, checked hierarchy out.
//!
//! Must never: apply half of anything. A program, or a command to a running hierarchy, is taken whole or
//! refused whole, with every problem found at its line and column.
//!
//! ```text
//!  text ─lexer─► tokens ─parser─► statements ─program─► names ─checker─► hierarchy
//!                                                          ▲
//!                                   vocabulary of the body ┘
//! ```
//!
//! The grammar stands in `docs/grammar.md`. Source: *A language for hierarchy assembly*.

mod checker;
mod formatter;
mod lexer;
mod loader;
mod nearest;
mod parser;
mod problem;
mod program;
mod running;
mod statement;
mod vocabulary;

pub use formatter::format;
pub use problem::{PROBLEMS_MAX, Problem, Problems};
pub use program::{Declared, Program, Superordinate};
pub use running::{Applied, COMMANDS_MAX, Running};
pub use statement::{Stated, Statement};
pub use vocabulary::Vocabulary;

use crate::hierarchy::Hierarchy;

/// Reads a program and checks it against the primitives of a body.
///
/// # Errors
/// Every problem found in the text, in the order of their lines.
pub fn check(text: &str, vocabulary: &Vocabulary) -> Result<Program, Problems> {
    let (statements, mut problems) = parser::parse_what_can_be(text);
    // With a sentence missing most of what could be found about the whole is not true; names are names still.
    let assembled = if problems.is_empty() {
        Program::assemble(&statements)
    } else {
        Err(Problems(Vec::new()))
    };
    match assembled {
        Ok(program) => checker::check(&program, vocabulary).map(|()| program),
        Err(Problems(more)) => {
            problems.extend(more);
            problems.extend(checker::unknown_primitives(&statements, vocabulary));
            Problems::none_of(problems)?;
            unreachable!("there was a problem")
        }
    }
}

/// Reads, checks and lays out a program.
///
/// # Errors
/// Every problem found in the text, in the order of their lines.
pub fn load(text: &str, vocabulary: &Vocabulary) -> Result<Hierarchy, Problems> {
    check(text, vocabulary).map(|program| loader::lay_out(&program, vocabulary))
}
