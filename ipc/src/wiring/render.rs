//! Errors as a person reads them: the line, the offending text underlined, what was expected.
//!
//! ```text
//! error[unknown-port]: "turn" has no input "headin"
//!   --> mine.toml:12:24
//!    |
//! 12 |   "runaway.heading -> turn.headin",
//!    |                       ^^^^^^^^^^^
//!    = did you mean "heading"? expected one of the inputs "compass", "heading", "reset"
//! ```
//! Must never let a byte of the file reach the terminal as a command: control characters are replaced.

use std::fmt::Write as _;
use std::ops::Range;

use super::diagnostic::{Diagnostic, Rejected, Source};

/// Longest piece of a line that is shown, in characters.
const SHOWN_MAX: usize = 160;

/// How much of a longer line is shown before the offending text.
const BEFORE: usize = 40;

/// What a piece of a report is, for those who paint it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// The word `error` with its code, and the underline.
    Error,
    /// What is wrong.
    Message,
    /// Line numbers and the frame.
    Frame,
    /// The underline of the other place, and what is said of it.
    Also,
}

/// Paints a piece of a report.
pub type Paint<'p> = &'p dyn Fn(Piece, &str) -> String;

/// A piece of one line of the file, with what is underlined in it.
struct Excerpt<'m> {
    line: usize,
    column: usize,
    text: String,
    indent: String,
    mark: String,
    piece: Piece,
    label: &'m str,
}

impl Source {
    /// Where every line begins.
    fn lines(&self) -> Vec<usize> {
        let ends = self
            .text
            .bytes()
            .enumerate()
            .filter(|(_, b)| *b == b'\n')
            .map(|(i, _)| i + 1);
        std::iter::once(0).chain(ends).collect()
    }

    fn excerpt<'m>(&self, lines: &[usize], at: &Range<usize>, piece: Piece, label: &'m str) -> Excerpt<'m> {
        let start = self.boundary(at.start);
        let end = self.boundary(at.end.max(start));
        let line = lines.partition_point(|l| *l <= start);
        let begin = lines[line - 1];
        let text = self.text[begin..]
            .split('\n')
            .next()
            .unwrap_or("")
            .trim_end_matches('\r');
        let column = self.text[begin..start].chars().count() + 1;
        let covered = self.text[start..end].split('\n').next().unwrap_or("");
        let wide = covered.trim_end_matches('\r').chars().count();
        let skip = if text.chars().count() > SHOWN_MAX {
            (column - 1).saturating_sub(BEFORE)
        } else {
            0
        };
        let lead = if skip > 0 { "…" } else { "" };
        let shown: String = text.chars().skip(skip).take(SHOWN_MAX).map(visible).collect();
        let tail = if text.chars().skip(skip).nth(SHOWN_MAX).is_some() {
            "…"
        } else {
            ""
        };
        let length = shown.chars().count();
        let ahead = column - 1 - skip;
        // Keeps tabs, so that the underline stands below what it means.
        let keep = |c: char| if c == '\t' { '\t' } else { ' ' };
        let indent: String = lead
            .chars()
            .chain(shown.chars())
            .take(ahead + lead.chars().count())
            .map(keep)
            .collect();
        let wide = wide.clamp(1, (length + 1).saturating_sub(ahead).max(1));
        let sign = if piece == Piece::Error { "^" } else { "-" };
        Excerpt {
            line,
            column,
            text: format!("{lead}{shown}{tail}"),
            indent,
            mark: sign.repeat(wide),
            piece,
            label,
        }
    }

    fn render(&self, lines: &[usize], diagnostic: &Diagnostic, paint: Paint<'_>, out: &mut String) {
        let within = diagnostic.within.as_deref();
        let file = within.unwrap_or(self);
        let own_lines = within.map(Source::lines);
        let main = file.excerpt(
            own_lines.as_deref().unwrap_or(lines),
            &diagnostic.at,
            Piece::Error,
            "",
        );
        let (line, column) = (main.line, main.column);
        let mut excerpts = vec![main];
        let also = diagnostic.also.as_ref();
        let mut named = also.map(|(at, label)| self.excerpt(lines, at, Piece::Also, label));
        if within.is_none() {
            excerpts.extend(named.take());
        }
        excerpts.sort_by_key(|e| e.line);
        let last = excerpts.iter().chain(&named).map(|e| e.line).max();
        let margin = last.map_or(1, |line| line.to_string().len());
        let kind = diagnostic
            .rule
            .map_or("error".into(), |rule| format!("error[{rule}]"));
        let _ = writeln!(
            out,
            "{}{}",
            paint(Piece::Error, &kind),
            paint(Piece::Message, &format!(": {}", printable(&diagnostic.message)))
        );
        let frame = |text: &str| paint(Piece::Frame, text);
        let _ = writeln!(
            out,
            "{} {}:{line}:{column}",
            frame(&format!("{:margin$}-->", "")),
            file.name
        );
        let bar = frame(&format!("{:margin$} |", ""));
        let _ = writeln!(out, "{bar}");
        let mut last = None;
        for e in excerpts.iter().chain(&named) {
            if within.is_some() && e.piece == Piece::Also {
                let arrow = frame(&format!("{:margin$}:::", ""));
                let _ = writeln!(out, "{arrow} {}:{}:{}\n{bar}", self.name, e.line, e.column);
            } else if last.is_some_and(|last| e.line > last + 1) {
                let _ = writeln!(out, "{}", frame(&format!("{:margin$}...", "")));
            }
            if last != Some(e.line) || within.is_some() {
                let number = frame(&format!("{:>margin$} |", e.line));
                let _ = writeln!(out, "{} {}", number, e.text);
            }
            last = Some(e.line);
            let under = format!(
                "{}{}{}",
                e.mark,
                if e.label.is_empty() { "" } else { " " },
                e.label
            );
            let _ = writeln!(out, "{bar} {}{}", e.indent, paint(e.piece, &under));
        }
        if !diagnostic.help.is_empty() {
            let _ = writeln!(
                out,
                "{} {}",
                frame(&format!("{:margin$} =", "")),
                printable(&diagnostic.help)
            );
        }
    }
}

fn visible(c: char) -> char {
    if c.is_control() && c != '\t' {
        '\u{fffd}'
    } else {
        c
    }
}

/// Text for one line of a terminal; a very long one is cut.
fn printable(text: &str) -> String {
    const TEXT_MAX: usize = 600;
    let mut shown: String = text.chars().take(TEXT_MAX).map(visible).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}

impl Rejected {
    /// The whole report, each piece painted by `paint`.
    pub fn painted(&self, paint: Paint<'_>) -> String {
        let lines = self.source.lines();
        let mut out = String::new();
        for diagnostic in &self.diagnostics {
            self.source.render(&lines, diagnostic, paint, &mut out);
            out.push('\n');
        }
        let n = self.count();
        let _ = write!(
            out,
            "{}: {n} error{}",
            self.source.name,
            if n == 1 { "" } else { "s" }
        );
        if self.more > 0 {
            let _ = write!(out, ", the first {} are shown", self.diagnostics.len());
        }
        out
    }
}

impl std::fmt::Display for Rejected {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.painted(&|_, text| text.into()))
    }
}
