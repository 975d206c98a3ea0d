//! Values and times as scenario files write them.
//!
//! Must never guess: a value has the form of its wire's kind, a time has a unit.

use ipc::clock::Span;
use ipc::message::{Kind, WORDS_MAX, Words};
use ipc::wiring::diagnostic::Findings;
use ipc::wiring::document::{self as doc, DeValue, Spanned};

/// A value as read: its words, and how many of them were given.
pub(crate) type Value = (Words, usize);

/// How a value of `kind` is written.
fn form(kind: Kind) -> &'static str {
    match kind {
        Kind::Pulse => "nothing or true, for a pulse",
        Kind::Bit => "true or false, for a bit",
        Kind::Number => "a number such as 1.0",
        Kind::Vector => "a vector [x, y]",
        Kind::Polar => "a polar vector [length, bearing in rad]",
        Kind::Map => "a map, up to 12 ranges [ahead, 30° left, ...]; those left out are 0",
        Kind::Pose => "a pose [x, y, heading in rad]",
    }
}

/// The value of a message of `kind`.
pub(crate) fn value(given: &Spanned<DeValue<'_>>, kind: Kind, findings: &mut Findings) -> Option<Value> {
    let mut words = [0.0; WORDS_MAX];
    let wrong = |findings: &mut Findings| {
        let message = format!("not a value of a wire that carries {kind}");
        findings.error(given.span(), message, format!("expected {}", form(kind)));
        None
    };
    match (kind, given.get_ref()) {
        (Kind::Pulse, DeValue::Boolean(true)) => Some((words, 0)),
        (Kind::Bit, DeValue::Boolean(bit)) => {
            words[0] = f64::from(u8::from(*bit));
            Some((words, 1))
        }
        (Kind::Number, DeValue::Integer(_) | DeValue::Float(_)) => {
            words[0] = doc::number(given, f64::MIN, f64::MAX, findings)?;
            Some((words, 1))
        }
        (Kind::Vector | Kind::Polar | Kind::Map | Kind::Pose, DeValue::Array(items)) => {
            let enough = items.len() == kind.words() || (kind == Kind::Map && items.len() <= kind.words());
            if !enough {
                return wrong(findings);
            }
            for (word, item) in words.iter_mut().zip(items.iter()) {
                *word = doc::number(item, f64::MIN, f64::MAX, findings)?;
            }
            Some((words, items.len()))
        }
        _ => wrong(findings),
    }
}

/// One time or a list of them, each with its place.
pub(crate) fn times(
    given: &Spanned<DeValue<'_>>,
    findings: &mut Findings,
) -> Vec<(Span, std::ops::Range<usize>)> {
    let items = match given.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => vec![given],
    };
    let time = |item: &Spanned<DeValue<'_>>| Some((doc::span(item, false, findings)?, item.span()));
    items.into_iter().filter_map(time).collect()
}

/// A message's words as a person reads them.
pub(crate) fn shown(words: &Words, kind: Kind) -> String {
    let used = &words[..kind.words()];
    match kind {
        Kind::Pulse => "a pulse".into(),
        Kind::Bit => (used[0] != 0.0).to_string(),
        Kind::Number => used[0].to_string(),
        _ => format!("{used:?}"),
    }
}
