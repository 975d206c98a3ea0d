//! A running hierarchy and the commands applied to it, each a text that can be listed and taken back.
//!
//! Must never be called inside an evaluation: a command is applied between two of them, all or nothing.

use super::problem::{Position, Problem, Problems};
use super::vocabulary::Vocabulary;
use super::{formatter, load};
use crate::hierarchy::Hierarchy;

/// Most commands kept for listing and undoing; more are refused, for the list is part of the saved program.
pub const COMMANDS_MAX: usize = 1024;

/// A command that was applied, as it stands in the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Applied {
    /// The statements, formatted.
    pub text: String,
    /// After which evaluation it was applied.
    pub after_evaluation: u64,
}

/// A hierarchy that runs, with the program it came from and all that was added since.
#[derive(Clone, Debug)]
pub struct Running {
    program: String,
    applied: Vec<Applied>,
    vocabulary: Vocabulary,
    hierarchy: Hierarchy,
    revision: u64,
}

impl Running {
    /// Loads a program.
    ///
    /// # Errors
    /// Every problem in the text.
    pub fn load(program: &str, vocabulary: Vocabulary) -> Result<Self, Problems> {
        let hierarchy = load(program, &vocabulary)?;
        Ok(Self {
            program: program.to_owned(),
            applied: Vec::new(),
            vocabulary,
            hierarchy,
            revision: 0,
        })
    }

    /// The hierarchy, for evaluation.
    pub fn hierarchy_mut(&mut self) -> &mut Hierarchy {
        &mut self.hierarchy
    }

    /// The hierarchy, to look at.
    #[must_use]
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The primitives of the body it runs on.
    #[must_use]
    pub fn vocabulary(&self) -> &Vocabulary {
        &self.vocabulary
    }

    /// Grows with every command applied or taken back: places in the hierarchy may have changed since.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The commands applied so far, first to last.
    #[must_use]
    pub fn list(&self) -> &[Applied] {
        &self.applied
    }

    /// Applies one or more statements, all or nothing. RMs that stay go on with what they were doing.
    ///
    /// # Errors
    /// Every problem, with line and column in the command; the hierarchy is then as it was.
    pub fn apply(&mut self, command: &str) -> Result<(), Problems> {
        let text = formatter::format(command)?;
        if self.applied.len() == COMMANDS_MAX {
            let at = Position { line: 1, column: 1 };
            let message =
                format!("{COMMANDS_MAX} commands were applied already; save the program and load it");
            return Err(Problems(vec![Problem::new(at, message)]));
        }
        let before = self.text();
        let hierarchy = load(&format!("{before}{command}"), &self.vocabulary)
            .map_err(|problems| relative(problems, before.matches('\n').count()))?;
        self.applied.push(Applied {
            text,
            after_evaluation: self.hierarchy.number(),
        });
        self.replace(hierarchy);
        Ok(())
    }

    /// Takes back the latest command and returns it; `None` when there is none.
    pub fn undo(&mut self) -> Option<Applied> {
        let undone = self.applied.pop()?;
        let hierarchy = load(&self.text(), &self.vocabulary).expect("it was loaded from this text before");
        self.replace(hierarchy);
        Some(undone)
    }

    /// The program with all commands, as text that loads to the same hierarchy.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.program.trim_end().to_owned();
        text.push('\n');
        for command in &self.applied {
            text.push_str(&command.text);
        }
        text
    }

    fn replace(&mut self, mut hierarchy: Hierarchy) {
        hierarchy.carry_over(&self.hierarchy);
        self.hierarchy = hierarchy;
        self.revision += 1;
    }
}

/// Moves the places of problems from the whole program to the command behind it.
fn relative(problems: Problems, lines_before: usize) -> Problems {
    let before = u32::try_from(lines_before).unwrap_or(u32::MAX);
    let moved = problems.0.into_iter().map(|mut problem| {
        if problem.line > before {
            problem.line -= before;
        } else {
            problem.message = format!(
                "{} (said at line {} of the program)",
                problem.message, problem.line
            );
            (problem.line, problem.column) = (1, 1);
        }
        problem
    });
    Problems(moved.collect())
}
