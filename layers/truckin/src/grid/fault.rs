//! Why a run or a results file was given up.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a run or a results file was given up.
#[derive(Debug)]
pub enum GridFault {
    /// The file is damaged, or holds another experiment. Nothing was written to it.
    Bad {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
    /// The machine would not do it.
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// What the system said.
        error: io::Error,
    },
    /// With checking switched on: a game broke the rules.
    Rules {
        /// Which game, and what.
        what: String,
    },
}

impl GridFault {
    pub(crate) fn bad(path: &Path, line: usize, what: impl Into<String>) -> Self {
        Self::Bad {
            path: path.to_owned(),
            line,
            what: what.into(),
        }
    }

    pub(crate) fn io(path: &Path, doing: &'static str, error: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            doing,
            error,
        }
    }
}

impl fmt::Display for GridFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bad { path, line, what } => write!(
                out,
                "{}:{line}: {what}\nnothing was written; name another file with --out, or put back what this one \
                 held",
                path.display()
            ),
            Self::Io { path, doing, error } => write!(out, "{}: {doing}: {error}", path.display()),
            Self::Rules { what } => write!(out, "the rules were broken: {what}"),
        }
    }
}

impl std::error::Error for GridFault {}
