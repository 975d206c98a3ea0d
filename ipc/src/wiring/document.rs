//! Reading a TOML document with every value's place in the file, and noting all that is wrong with it.
//!
//! Must never interpret: it knows tables, strings and times, not layers.

use std::borrow::Cow;
use std::ops::Range;

pub use toml::Spanned;
pub use toml::de::{DeTable, DeValue};

use super::diagnostic::{Findings, one_of};
use super::rule::Rule;
pub use super::syntax::{FILE_BYTES_MAX, parse};
use crate::clock::Span;

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub at: Range<usize>,
}

/// A table being read: keys are taken out one by one, what is left at the end is unknown.
pub struct Keys<'t, 's> {
    table: &'t DeTable<'s>,
    at: Range<usize>,
    what: Cow<'static, str>,
    known: Vec<&'static str>,
}

impl<'t, 's> Keys<'t, 's> {
    /// Reads `table`, which stands at `at` and is called `what` in errors.
    pub fn new(table: &'t DeTable<'s>, at: Range<usize>, what: impl Into<Cow<'static, str>>) -> Self {
        Keys {
            table,
            at,
            what: what.into(),
            known: Vec::new(),
        }
    }

    /// Where the table stands.
    pub fn at(&self) -> Range<usize> {
        self.at.clone()
    }

    /// What the table is called in errors.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Whether there are keys that were not asked for.
    pub fn has_others(&self) -> bool {
        self.table
            .iter()
            .any(|(k, _)| !self.known.contains(&k.get_ref().as_ref()))
    }

    /// Whether `key` is given.
    pub fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// The value of `key`, which then still is not asked for.
    pub fn get(&self, key: &str) -> Option<&'t Spanned<DeValue<'s>>> {
        self.table.get(key)
    }

    /// Every key with its place and value, in the order of the file; all of them count as asked for.
    pub fn all(self) -> impl Iterator<Item = (Placed<String>, &'t Spanned<DeValue<'s>>)> {
        self.table.iter().map(|(key, value)| {
            let placed = Placed {
                value: key.get_ref().to_string(),
                at: key.span(),
            };
            (placed, value)
        })
    }

    /// The value of `key`.
    pub fn take(&mut self, key: &'static str) -> Option<&'t Spanned<DeValue<'s>>> {
        self.known.push(key);
        self.table.get(key)
    }

    /// The value of `key`, which must be there.
    pub fn need(&mut self, key: &'static str, findings: &mut Findings) -> Option<&'t Spanned<DeValue<'s>>> {
        let found = self.take(key);
        if found.is_none() {
            let message = format!("{} has no {key:?}", self.what);
            findings.refuse(Rule::MissingKey, self.at(), message, format!("add {key} = ..."));
        }
        found
    }

    /// Notes every key that was not asked for.
    pub fn finish(self, findings: &mut Findings) {
        for (key, _) in self.table {
            if !self.known.contains(&key.get_ref().as_ref()) {
                let help = findings.one_of("key", key.get_ref(), self.known.iter().copied());
                let message = format!("unknown key {:?} in {}", key.get_ref(), self.what);
                findings.refuse(Rule::UnknownKey, key.span(), message, help);
            }
        }
    }
}

fn wrong(value: &Spanned<DeValue<'_>>, expected: &str, findings: &mut Findings) {
    let message = format!("{} found", a(value.get_ref().type_str()));
    findings.refuse(
        Rule::WrongType,
        value.span(),
        message,
        format!("expected {expected}"),
    );
}

fn a(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {noun}")
}

/// A string.
pub fn text(value: &Spanned<DeValue<'_>>, expected: &str, findings: &mut Findings) -> Option<Placed<String>> {
    match value.get_ref() {
        DeValue::String(s) => Some(Placed {
            value: s.to_string(),
            at: value.span(),
        }),
        _ => {
            wrong(value, expected, findings);
            None
        }
    }
}

/// One of some words.
pub fn word(
    value: &Spanned<DeValue<'_>>,
    what: &str,
    words: &[&str],
    findings: &mut Findings,
) -> Option<usize> {
    let plain = |help: String| help.replace(&format!("one of the {what}s "), "one of ");
    let expected = plain(one_of(what, "", words.iter().copied()));
    let expected = expected.strip_prefix("expected ").unwrap_or(&expected);
    let given = text(value, expected, findings)?;
    let found = words.iter().position(|w| *w == given.value);
    if found.is_none() {
        let help = plain(findings.one_of(what, &given.value, words.iter().copied()));
        let message = format!("unknown {what} {:?}", given.value);
        findings.refuse(Rule::UnknownWord, given.at, message, help);
    }
    found
}

/// A whole number from `low` to `high`.
pub fn whole(value: &Spanned<DeValue<'_>>, low: u64, high: u64, findings: &mut Findings) -> Option<u64> {
    let expected = format!("a whole number from {low} to {high}");
    match value.get_ref() {
        DeValue::Integer(n) => match u64::from_str_radix(&n.as_str().replace('_', ""), n.radix()) {
            Ok(n) if (low..=high).contains(&n) => Some(n),
            _ => {
                let message = format!("{} is out of range", n.as_str());
                let help = format!("expected {expected}");
                findings.refuse(Rule::OutOfRange, value.span(), message, help);
                None
            }
        },
        _ => {
            wrong(value, &expected, findings);
            None
        }
    }
}

/// A finite number from `low` to `high`.
pub fn number(value: &Spanned<DeValue<'_>>, low: f64, high: f64, findings: &mut Findings) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Integer(n) => i64::from_str_radix(&n.as_str().replace('_', ""), n.radix())
            .ok()
            .map(|n| n as f64),
        DeValue::Float(n) => n.as_str().replace('_', "").parse::<f64>().ok(),
        _ => {
            let expected = number_range(low, high);
            wrong(
                value,
                expected.strip_prefix("expected ").unwrap_or("a number"),
                findings,
            );
            return None;
        }
    };
    let (rule, what) = match parsed {
        Some(n) if n.is_finite() && (low..=high).contains(&n) => return Some(n),
        Some(n) if n.is_finite() => (Rule::OutOfRange, format!("{n} is out of range")),
        Some(n) if n.is_nan() => (Rule::NotFinite, "this is not a number".into()),
        _ => (Rule::NotFinite, "this number is infinite or too long".into()),
    };
    findings.refuse(rule, value.span(), what, number_range(low, high));
    None
}

fn number_range(low: f64, high: f64) -> String {
    match (low > f64::MIN, high < f64::MAX) {
        (true, true) => format!("expected a number from {low} to {high}"),
        (true, false) => format!("expected a number of at least {low}"),
        (false, true) => format!("expected a number of at most {high}"),
        (false, false) => "expected a finite number".into(),
    }
}

/// `true` or `false`.
pub fn bit(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<bool> {
    match value.get_ref() {
        DeValue::Boolean(b) => Some(*b),
        _ => {
            wrong(value, "true or false", findings);
            None
        }
    }
}

/// A time with a unit; longer than zero if `positive`.
pub fn span(value: &Spanned<DeValue<'_>>, positive: bool, findings: &mut Findings) -> Option<Span> {
    let given = text(value, "a time with a unit, such as \"20ms\"", findings)?;
    match Span::parse(&given.value) {
        Ok(Span::ZERO) if positive => {
            let message = format!("{:?} is no time at all", given.value);
            let help = "expected a time longer than zero, such as \"20ms\"";
            findings.refuse(Rule::NotPositive, given.at, message, help);
            None
        }
        Ok(span) => Some(span),
        Err(_) if negative(&given.value) => {
            let message = format!("{:?} is negative", given.value);
            let help = "expected a time longer than zero, such as \"20ms\"";
            findings.refuse(Rule::NotPositive, given.at, message, help);
            None
        }
        Err(help) => {
            let message = format!("{:?} is not a time", given.value);
            findings.refuse(Rule::BadTime, given.at, message, unit_help(&given.value, help));
            None
        }
    }
}

/// Whether a text would be a time but for its sign.
fn negative(text: &str) -> bool {
    text.strip_prefix('-').is_some_and(|t| Span::parse(t).is_ok())
}

/// Help for units that people write and that are not taken.
fn unit_help(given: &str, help: String) -> String {
    let split = given.find(|c: char| c.is_alphabetic() || c == '\u{b5}');
    let (number, unit) = given.split_at(split.unwrap_or(given.len()));
    let number = number.trim();
    if number.parse::<f64>().is_err() {
        return help;
    }
    let instead = match unit.trim().to_lowercase().as_str() {
        "" => return format!("the unit is missing: write \"{number}ms\" or \"{number}s\""),
        "\u{b5}s" | "\u{3bc}s" | "usec" => "us",
        "sec" | "secs" | "second" | "seconds" => "s",
        "msec" | "millis" | "ms" => "ms",
        "m" | "mins" | "minute" | "minutes" => "min",
        "hz" => return format!("a period is a time, not a rate: {}", period_of(number)),
        _ => return format!("{help}; the units are ns, us, ms, s and min"),
    };
    format!("did you mean \"{number}{instead}\"? the units are ns, us, ms, s and min")
}

fn period_of(rate: &str) -> String {
    match rate.parse::<f64>().ok().and_then(|r| Span::from_seconds(1.0 / r)) {
        Some(period) if period > Span::ZERO => format!("write \"{period}\""),
        _ => "write it as a time, such as \"20ms\"".into(),
    }
}

/// The elements of an array.
pub fn array<'t, 's>(
    value: &'t Spanned<DeValue<'s>>,
    expected: &str,
    findings: &mut Findings,
) -> Vec<&'t Spanned<DeValue<'s>>> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => {
            wrong(value, expected, findings);
            Vec::new()
        }
    }
}

/// The elements of a list of at most `most` of `what`.
pub fn list<'t, 's>(
    value: &'t Spanned<DeValue<'s>>,
    what: &str,
    most: usize,
    findings: &mut Findings,
) -> Vec<&'t Spanned<DeValue<'s>>> {
    let items = array(value, &format!("a list of {what}"), findings);
    if items.len() > most {
        let message = format!("the list has {} elements", items.len());
        let help = format!("expected at most {most}");
        findings.refuse(Rule::OutOfRange, value.span(), message, help);
    }
    items
}

/// A table.
pub fn table<'t, 's>(
    value: &'t Spanned<DeValue<'s>>,
    what: impl Into<Cow<'static, str>>,
    findings: &mut Findings,
) -> Option<Keys<'t, 's>> {
    let what = what.into();
    match value.get_ref() {
        DeValue::Table(t) => Some(Keys::new(t, value.span(), what)),
        _ => {
            wrong(value, &format!("a table: {what}"), findings);
            None
        }
    }
}
