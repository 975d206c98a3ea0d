//! Diagnostics: what is wrong with a file, where, and what was expected instead.
//!
//! Must never stop at the first error: a file is read to its end and every error is shown at once.

use std::fmt::Write as _;
use std::ops::Range;

use serde::Serialize;

/// One error in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The offending bytes.
    pub at: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
}

/// A diagnostic with its place spelled out, as reports carry it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Located {
    /// The file's name.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
}

/// A text with its name, and what was found wrong with it.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file's name, as errors show it.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// The errors of one file; there is at least one.
#[derive(Clone, Debug)]
pub struct Rejected {
    /// The file.
    pub source: Source,
    /// Its errors, in the order of the file.
    pub diagnostics: Vec<Diagnostic>,
}

impl Source {
    /// A text under a name.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source {
            name: name.into(),
            text: text.into(),
        }
    }

    /// Line and column (both from 1, columns in characters) of a byte offset.
    pub fn place(&self, offset: usize) -> (usize, usize) {
        let offset = (0..=offset.min(self.text.len()))
            .rev()
            .find(|&o| self.text.is_char_boundary(o))
            .unwrap_or(0);
        let before = &self.text[..offset];
        let line = before.matches('\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |n| n + 1);
        (line, before[start..].chars().count() + 1)
    }

    fn render(&self, diagnostic: &Diagnostic, out: &mut String) {
        let (line, column) = self.place(diagnostic.at.start);
        let text = self.text.lines().nth(line - 1).unwrap_or("");
        let covered = self.text.get(diagnostic.at.clone()).unwrap_or("");
        let wide = covered.lines().next().map_or(0, |l| l.chars().count());
        let wide = wide.clamp(1, (text.chars().count() + 2).saturating_sub(column).max(1));
        let margin = line.to_string().len();
        // Keeps tabs, so that the underline stands below what it means.
        let indent: String = text
            .chars()
            .take(column - 1)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let _ = writeln!(out, "error: {}", diagnostic.message);
        let _ = writeln!(out, "{:margin$}--> {}:{line}:{column}", "", self.name);
        let _ = writeln!(out, "{:margin$} |", "");
        let _ = writeln!(out, "{line} | {text}");
        let _ = writeln!(out, "{:margin$} | {indent}{}", "", "^".repeat(wide));
        if !diagnostic.help.is_empty() {
            let _ = writeln!(out, "{:margin$} = {}", "", diagnostic.help);
        }
    }
}

impl Rejected {
    /// Every error with its place.
    pub fn located(&self) -> Vec<Located> {
        let place = |d: &Diagnostic| {
            let (line, column) = self.source.place(d.at.start);
            let (message, help) = (d.message.clone(), d.help.clone());
            Located {
                file: self.source.name.clone(),
                line,
                column,
                message,
                help,
            }
        };
        self.diagnostics.iter().map(place).collect()
    }
}

impl std::fmt::Display for Rejected {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = String::new();
        for diagnostic in &self.diagnostics {
            self.source.render(diagnostic, &mut out);
            out.push('\n');
        }
        let n = self.diagnostics.len();
        let _ = write!(
            out,
            "{}: {n} error{}",
            self.source.name,
            if n == 1 { "" } else { "s" }
        );
        f.write_str(&out)
    }
}

impl std::error::Error for Rejected {}

/// Collects errors while a file is read.
#[derive(Debug, Default)]
pub struct Findings(Vec<Diagnostic>);

impl Findings {
    /// Notes an error at `at`.
    pub fn error(&mut self, at: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.0.push(Diagnostic {
            at,
            message: message.into(),
            help: help.into(),
        });
    }

    /// Whether nothing was found wrong so far.
    pub fn is_clean(&self) -> bool {
        self.0.is_empty()
    }

    /// `value`, or every error found in `source`, in the order of the file.
    ///
    /// # Errors
    /// When anything was noted.
    pub fn into_result<T>(mut self, source: &Source, value: Option<T>) -> Result<T, Rejected> {
        match value {
            Some(value) if self.0.is_empty() => Ok(value),
            _ => {
                assert!(!self.0.is_empty(), "a file without a value has an error to show");
                self.0.sort_by_key(|d| (d.at.start, d.at.end));
                self.0.dedup();
                Err(Rejected {
                    source: source.clone(),
                    diagnostics: self.0,
                })
            }
        }
    }
}

/// `expected one of …`, with the nearest name first when one is near.
pub fn one_of<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    if known.is_empty() {
        return format!("there is no {what} here");
    }
    known.sort_by_cached_key(|k| (strsim::damerau_levenshtein(given, k), k.to_string()));
    let near = strsim::damerau_levenshtein(given, known[0]) <= 1 + given.len() / 4;
    let lead = if near {
        format!("did you mean {:?}? ", known[0])
    } else {
        String::new()
    };
    known.sort_unstable();
    let shown = known
        .iter()
        .take(12)
        .map(|k| format!("{k:?}"))
        .collect::<Vec<_>>()
        .join(", ");
    let more = known.len().saturating_sub(12);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    format!("{lead}expected one of the {what}s {shown}{more}")
}
