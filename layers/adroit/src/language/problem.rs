//! What is wrong with a program: line, column, what was expected, and the nearest name.

use std::fmt;

use super::nearest::nearest;

/// Most problems reported for one text.
pub const PROBLEMS_MAX: usize = 50;

/// Where a word stands in a text, both counted from one; columns count characters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Position {
    pub(crate) line: u32,
    pub(crate) column: u32,
}

/// One problem in a program or a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Line, from one.
    pub line: u32,
    /// Column in characters, from one.
    pub column: u32,
    /// What is wrong, and what was expected instead.
    pub message: String,
    /// A known name close to the one written.
    pub nearest: Option<String>,
}

impl Problem {
    pub(crate) fn new(at: Position, message: impl Into<String>) -> Self {
        Self {
            line: at.line,
            column: at.column,
            message: message.into(),
            nearest: None,
        }
    }

    /// Adds the known name nearest to the one written, if one is near enough.
    pub(crate) fn near<'a>(mut self, written: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        self.nearest = nearest(written, known).map(str::to_owned);
        self
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}: {}", self.line, self.column, self.message)?;
        match &self.nearest {
            Some(name) => write!(out, "; did you mean `{name}`?"),
            None => Ok(()),
        }
    }
}

/// All problems of a text, in the order of their places; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// Orders and bounds the problems; `Ok` when there are none.
    pub(crate) fn none_of(mut found: Vec<Problem>) -> Result<(), Self> {
        if found.is_empty() {
            return Ok(());
        }
        found.sort_by_key(|problem| (problem.line, problem.column));
        found.dedup();
        found.truncate(PROBLEMS_MAX);
        Err(Self(found))
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (count, problem) in self.0.iter().enumerate() {
            if count > 0 {
                writeln!(out)?;
            }
            write!(out, "{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}
