//! Diagnostics: what is wrong with a file, where, and what was expected instead.
//!
//! Must never stop at the first error: a file is read to its end and every error is shown at once, up to a
//! number that nobody would read anyway.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;

use super::catalog::Fault;
use super::rule::Rule;

/// Most errors of one file that are kept and shown; the rest are only counted.
pub const FINDINGS_MAX: usize = 200;

/// Most names that are compared with misspelt ones in one file: enough for every slip of a person, and a
/// tenth of a second for a file made of nothing but slips.
const COMPARISONS_MAX: usize = 100_000;

/// Longest word for which a near one is looked for.
const WORD_MAX: usize = 64;

/// One error in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The rule that is broken; none in files of other grammars.
    pub rule: Option<Rule>,
    /// The offending bytes.
    pub at: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
    /// Another place that belongs to it, with what stands there; always in the file that was read.
    pub also: Option<(Range<usize>, String)>,
    /// The file that the offending bytes stand in, if it is one that the file that was read names.
    pub within: Option<Arc<Source>>,
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
    /// The code of the rule that is broken.
    pub rule: Option<Rule>,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
    /// Line and column of another place that belongs to it.
    pub also: Option<(usize, usize)>,
    /// The file of that other place, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub also_file: Option<String>,
}

/// A text with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's name, as errors show it.
    pub name: String,
    /// Its text.
    pub text: String,
    /// Where the files lie that it names.
    pub files: Files,
}

/// Where the files lie that a text names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Files {
    /// Nowhere: a text that is built in, or comes over a socket, may name none.
    #[default]
    Nowhere,
    /// In this folder.
    In(PathBuf),
    /// Not here any more: what is named is not read. For recordings, whose body is not built again.
    Unread,
}

/// The errors of one file; there is at least one.
#[derive(Clone, Debug)]
pub struct Rejected {
    /// The file.
    pub source: Source,
    /// Its errors, in the order of the file; at most [`FINDINGS_MAX`].
    pub diagnostics: Vec<Diagnostic>,
    /// How many more there were.
    pub more: usize,
}

impl Source {
    /// A text under a name, which may name no files.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source {
            name: name.into(),
            text: text.into(),
            files: Files::Nowhere,
        }
    }

    /// The text of the file at `path`; files that it names lie in the same folder, or are found from there.
    pub fn of_file(path: &Path, text: impl Into<String>) -> Source {
        Source::new(path.display().to_string(), text).beside(path)
    }

    /// The same text, whose files are found from the folder of `path`.
    pub fn beside(mut self, path: &Path) -> Source {
        self.files = Files::In(path.parent().unwrap_or(Path::new("")).into());
        self
    }

    /// The bytes of a file as text.
    ///
    /// # Errors
    /// When they are not UTF-8, with the place of the first byte that is not.
    pub fn from_bytes(name: impl Into<String>, bytes: Vec<u8>) -> Result<Source, Rejected> {
        let name = name.into();
        let error = match String::from_utf8(bytes) {
            Ok(text) => return Ok(Source::new(name, text)),
            Err(error) => error,
        };
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let message = format!("the byte {:#04x} is not text", bytes[valid]);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let mut findings = Findings::default();
        let help = "expected a text file in UTF-8; save it again with that encoding";
        findings.refuse(Rule::NotText, valid..valid + 1, message, help);
        findings.into_result(&Source::new(name, text), None)
    }

    /// The last boundary between characters that is not after `offset`.
    pub(super) fn boundary(&self, offset: usize) -> usize {
        let offset = offset.min(self.text.len());
        let near = (offset.saturating_sub(3)..=offset).rev();
        near.into_iter()
            .find(|o| self.text.is_char_boundary(*o))
            .unwrap_or(0)
    }

    /// Line and column (both from 1, columns in characters) of a byte offset.
    pub fn place(&self, offset: usize) -> (usize, usize) {
        let offset = self.boundary(offset);
        let before = &self.text[..offset];
        let line = before.bytes().filter(|b| *b == b'\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |n| n + 1);
        (line, before[start..].chars().count() + 1)
    }
}

impl Diagnostic {
    /// Where it belongs in the file that was read.
    pub(super) fn here(&self) -> &Range<usize> {
        match (&self.within, &self.also) {
            (Some(_), Some((at, _))) => at,
            _ => &self.at,
        }
    }
}

impl Rejected {
    /// Every error with its place.
    pub fn located(&self) -> Vec<Located> {
        let place = |d: &Diagnostic| {
            let file = d.within.as_deref().unwrap_or(&self.source);
            let (line, column) = file.place(d.at.start);
            Located {
                file: file.name.clone(),
                line,
                column,
                rule: d.rule,
                message: d.message.clone(),
                help: d.help.clone(),
                also: d.also.as_ref().map(|(at, _)| self.source.place(at.start)),
                also_file: d.within.as_ref().map(|_| self.source.name.clone()),
            }
        };
        self.diagnostics.iter().map(place).collect()
    }

    /// How many errors the file has.
    pub fn count(&self) -> usize {
        self.diagnostics.len() + self.more
    }
}

impl std::error::Error for Rejected {}

/// Collects errors while a file is read.
#[derive(Debug, Default)]
pub struct Findings {
    list: Vec<Diagnostic>,
    more: usize,
    compared: usize,
    lost: bool,
    lost_lines: bool,
}

impl Findings {
    /// Notes an error at `at`, of a grammar whose rules have no codes.
    pub fn error(&mut self, at: Range<usize>, message: impl Into<String>, help: impl Into<String>) {
        self.note(Diagnostic {
            rule: None,
            at,
            message: message.into(),
            help: help.into(),
            also: None,
            within: None,
        });
    }

    /// Notes that `rule` is broken at `at`.
    pub fn refuse(
        &mut self,
        rule: Rule,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.note(Diagnostic {
            rule: Some(rule),
            at,
            message: message.into(),
            help: help.into(),
            also: None,
            within: None,
        });
    }

    /// Notes that `rule` is broken at `at`, together with another place and what stands there.
    pub fn refuse_both(
        &mut self,
        rule: Rule,
        at: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
        also: (Range<usize>, String),
    ) {
        self.note(Diagnostic {
            rule: Some(rule),
            at,
            message: message.into(),
            help: help.into(),
            also: Some(also),
            within: None,
        });
    }

    /// Notes a fault of the file `within`, which is named at `named`.
    pub fn refuse_within(&mut self, rule: Rule, within: &Arc<Source>, fault: Fault, named: Range<usize>) {
        self.note(Diagnostic {
            rule: Some(rule),
            at: fault.at,
            message: fault.message,
            help: fault.help,
            also: Some((named, "named here".into())),
            within: Some(within.clone()),
        });
    }

    fn note(&mut self, new: Diagnostic) {
        if self.list.len() >= FINDINGS_MAX {
            self.more += 1;
        } else if !self.list.contains(&new) {
            self.list.push(new);
        }
    }

    /// Notes that a wire or a tap could not be read: a module that seems to lack one may not.
    pub fn lose_wire(&mut self) {
        self.lost = true;
    }

    /// Notes that whole lines could not be read: whatever seems to be missing may stand in them.
    pub fn lose_lines(&mut self) {
        self.lost = true;
        self.lost_lines = true;
    }

    /// Whether a wire or a tap may stand in what could not be read.
    pub fn has_lost_wires(&self) -> bool {
        self.lost
    }

    /// Whether anything may stand in what could not be read.
    pub fn has_lost_lines(&self) -> bool {
        self.lost_lines
    }

    /// How many errors were found so far.
    pub fn count(&self) -> usize {
        self.list.len() + self.more
    }

    /// Whether nothing was found wrong so far.
    pub fn is_clean(&self) -> bool {
        self.list.is_empty()
    }

    /// `expected one of …` as [`one_of`] says it; stops looking for near names in a file full of slips.
    pub fn one_of<'a>(
        &mut self,
        what: &str,
        given: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> String {
        // An error that will not be shown needs no help.
        if self.list.len() >= FINDINGS_MAX {
            return String::new();
        }
        let known: Vec<&str> = known.into_iter().collect();
        self.compared += known.len();
        let given = if self.compared > COMPARISONS_MAX {
            ""
        } else {
            given
        };
        one_of(what, given, known)
    }

    /// `value`, or every error found in `source`, in the order of the file.
    ///
    /// # Errors
    /// When anything was noted.
    pub fn into_result<T>(mut self, source: &Source, value: Option<T>) -> Result<T, Rejected> {
        match value {
            Some(value) if self.list.is_empty() => Ok(value),
            _ => {
                assert!(
                    !self.list.is_empty(),
                    "a file without a value has an error to show"
                );
                self.list
                    .sort_by_key(|d| (d.here().start, d.here().end, d.at.start, d.at.end));
                Err(Rejected {
                    source: source.clone(),
                    diagnostics: self.list,
                    more: self.more,
                })
            }
        }
    }

    /// Keeps only the errors that `keep` wants.
    pub(super) fn retain(&mut self, keep: impl FnMut(&Diagnostic) -> bool) {
        self.list.retain(keep);
    }
}

/// `expected one of …`, with the nearest name first when one is near.
pub fn one_of<'a>(what: &str, given: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    if known.is_empty() {
        return format!("there is no {what} here");
    }
    known.sort_unstable();
    known.dedup();
    let lead = nearest(given, &known).map_or(String::new(), |near| format!("did you mean {near:?}? "));
    if let [only] = known.as_slice() {
        return format!("{lead}expected {only:?}, the only {what} here");
    }
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

/// The known name nearest to a misspelt one, if one is near enough to be meant.
fn nearest<'k>(given: &str, known: &[&'k str]) -> Option<&'k str> {
    if given.is_empty() || given.len() > WORD_MAX {
        return None;
    }
    let given = given.to_lowercase();
    let far = 1 + given.len() / 4;
    let near = known
        .iter()
        .filter(|k| k.len().abs_diff(given.len()) <= far)
        .map(|k| (strsim::osa_distance(&given, &k.to_lowercase()), *k))
        .min()?;
    (near.0 <= far).then_some(near.1)
}
