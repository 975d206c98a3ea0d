//! From text to a TOML document; where the text is not TOML, the rest of it is still read.
//!
//! Must never let one slip hide the others, nor show what follows from a slip as an error of its own.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::diagnostic::{Findings, Source};
use super::rule::Rule;

/// Longest file that is read; a creature of 10,000 modules has about 1 MiB.
pub const FILE_BYTES_MAX: usize = 4 << 20;

/// Most levels of tables and lists in a file; a tap in a layer's list is at the fourth.
const DEPTH_MAX: usize = 16;

/// The root table of `source`; syntax errors go to `findings`.
pub fn parse<'s>(source: &'s Source, findings: &mut Findings) -> Option<Spanned<DeTable<'s>>> {
    if source.text.len() > FILE_BYTES_MAX {
        let message = format!("the file has {} bytes", source.text.len());
        let help = format!("expected at most {FILE_BYTES_MAX} bytes");
        findings.refuse(Rule::FileTooLong, 0..0, message, help);
        return None;
    }
    if let Some(at) = too_deep(&source.text) {
        let help = format!("expected at most {DEPTH_MAX} levels; a creature file needs four");
        findings.refuse(Rule::Syntax, at, "tables or lists are nested too deep", help);
        return None;
    }
    let (table, errors) = DeTable::parse_recoverable(&source.text);
    let mut last_line = None;
    for error in &errors {
        let at = error.span().unwrap_or(0..0);
        if error.message().starts_with("duplicate key") {
            twice(source, table.get_ref(), at, findings);
            continue;
        }
        findings.lose_lines();
        // What follows on the same line mostly follows from the first slip.
        let line = line_around(&source.text, at.start);
        if last_line.as_ref() != Some(&line) {
            let (message, help) = explain(error.message(), &source.text, &at);
            findings.refuse(Rule::Syntax, at, message, help);
        }
        last_line = Some(line);
    }
    Some(table)
}

/// Drops what was found on lines that are not TOML: it follows from that.
pub(super) fn drop_echoes(source: &Source, findings: &mut Findings) {
    if !findings.has_lost_lines() {
        return;
    }
    let mut broken: Vec<Range<usize>> = Vec::new();
    findings.retain(|d| {
        if d.rule == Some(Rule::Syntax) {
            broken.push(broken_by(&source.text, d.at.start));
        }
        true
    });
    findings.retain(|d| {
        d.rule == Some(Rule::Syntax)
            || !broken
                .iter()
                .any(|b| b.start <= d.here().start && d.here().start <= b.end)
    });
}

/// What a slip at `offset` makes unreadable: its line or, if that should begin a table, everything up to the
/// next that does.
fn broken_by(text: &str, offset: usize) -> Range<usize> {
    let line = line_around(text, offset);
    if !text[line.clone()].trim_start().starts_with('[') {
        return line;
    }
    let next = text[line.end..].find("\n[");
    line.start..next.map_or(text.len(), |n| line.end + n)
}

/// The bytes of the line that `offset` stands in.
fn line_around(text: &str, offset: usize) -> Range<usize> {
    let bytes = text.as_bytes();
    let offset = offset.min(bytes.len());
    let start = bytes[..offset]
        .iter()
        .rposition(|b| *b == b'\n')
        .map_or(0, |n| n + 1);
    let end = bytes[offset..]
        .iter()
        .position(|b| *b == b'\n')
        .map_or(bytes.len(), |n| offset + n);
    start..end
}

/// What is wrong and what was expected, in the words of this file rather than of its grammar.
fn explain(said: &str, text: &str, at: &Range<usize>) -> (String, String) {
    let said = said.replace('\n', "; ");
    let (what, expected) = match said.split_once(", expected ") {
        Some((what, expected)) => (what.to_string(), format!("expected {expected}")),
        None => (said, "expected TOML, see https://toml.io".into()),
    };
    let line = &text[line_around(text, at.start)];
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    if line.trim_end().ends_with('=') && at.start >= line_around(text, at.start).start {
        let key = line.trim_end().trim_end_matches('=').trim();
        return (
            format!("{key} has no value"),
            format!("expected a value after {:?}", "="),
        );
    }
    let bare = value.split(['#', ',', '}', ']']).next().unwrap_or("").trim();
    let time = bare.starts_with(|c: char| c.is_ascii_digit()) && bare.ends_with(|c: char| c.is_alphabetic());
    let word = bare.starts_with(|c: char| c.is_alphabetic());
    let quoted = bare.chars().all(|c| c.is_alphanumeric() || " .-_>".contains(c));
    if (time || word) && quoted && !["inf", "nan", "true", "false"].contains(&bare) {
        return (what, format!("names and times stand in quotes: write {bare:?}"));
    }
    (what, expected)
}

/// A key that is given twice, at `at`, with the place of the first.
fn twice(source: &Source, root: &DeTable<'_>, at: Range<usize>, findings: &mut Findings) {
    let text = source.text.get(at.clone()).unwrap_or("");
    let name = text.trim_matches(['"', '\'']);
    let message = format!("{name:?} is given twice");
    let help = "remove one of the two";
    let mut first = None;
    earlier(root, name, &at, &source.text, &mut first);
    let first = first.or_else(|| earlier_header(&source.text, &at));
    match first {
        Some(first) => {
            let also = (first, "first here".into());
            findings.refuse_both(Rule::DuplicateKey, at, message, help, also);
        }
        None => findings.refuse(Rule::DuplicateKey, at, message, help),
    }
}

/// The last key called `name` before `at`, in tables whose keys may be followed by the one at `at`.
fn earlier(table: &DeTable<'_>, name: &str, at: &Range<usize>, text: &str, found: &mut Option<Range<usize>>) {
    for (key, value) in table {
        let here = key.span();
        if key.get_ref() == name
            && here.start < at.start
            && found.as_ref().is_none_or(|f| f.start < here.start)
        {
            *found = Some(here);
        }
        let span = value.span();
        let around = span.contains(&at.start);
        let begins = |sign: &str| text.get(span.clone()).is_some_and(|t| t.starts_with(sign));
        match value.get_ref() {
            DeValue::Table(inner) if around || !begins("{") => earlier(inner, name, at, text, found),
            DeValue::Array(items) if around || begins("[[") => {
                for inner in items.iter().filter_map(|i| i.get_ref().as_table()) {
                    earlier(inner, name, at, text, found);
                }
            }
            _ => {}
        }
    }
}

/// The first line that is the same table header as the one around `at`.
fn earlier_header(text: &str, at: &Range<usize>) -> Option<Range<usize>> {
    let header = text[line_around(text, at.start)].split('#').next()?.trim();
    let mut start = 0;
    for line in text[..at.start].split_inclusive('\n') {
        if header.starts_with('[') && line.split('#').next()?.trim() == header {
            let lead = line.len() - line.trim_start().len();
            return Some(start + lead..start + lead + header.len());
        }
        start += line.len();
    }
    None
}

/// Where a key or a value goes deeper than [`DEPTH_MAX`]: whoever walks the document may then recurse.
fn too_deep(text: &str) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    let (mut open, mut dots, mut i) = (0_usize, 0_usize, 0);
    while i < bytes.len() {
        match bytes[i] {
            quote @ (b'"' | b'\'') => i = past_string(bytes, i, quote),
            b'#' => i = line_around(text, i).end,
            b'[' | b'{' => open += 1,
            b']' | b'}' => open = open.saturating_sub(1),
            b'.' => dots += 1,
            b'\n' | b',' | b'=' => dots = 0,
            _ => {}
        }
        if open > DEPTH_MAX || dots > DEPTH_MAX {
            return Some(i..i + 1);
        }
        i += 1;
    }
    None
}

/// The last byte of the string that begins at `start`.
fn past_string(bytes: &[u8], start: usize, quote: u8) -> usize {
    let triple = bytes[start..].starts_with(&[quote; 3]);
    let mut i = start + if triple { 3 } else { 1 };
    while i < bytes.len() {
        match bytes[i] {
            b'\\' if quote == b'"' => i += 1,
            b'\n' if !triple => return i,
            b if b == quote && !triple => return i,
            b if b == quote && bytes[i..].starts_with(&[quote; 3]) => return i + 2,
            _ => {}
        }
        i += 1;
    }
    i
}
