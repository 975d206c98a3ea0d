//! Whether what came is what was expected, and if not, what came instead.
//!
//! Must never run anything.

use ipc::clock::Span;
use ipc::message::Words;

use crate::around::nearest;
use crate::expectations::CAUSES;
use crate::plan::{Count, Expectation, Messages, Rule, Scenario, What, Window};
use crate::run::{Outcome, Seen};
use crate::values::shown;

/// An expectation that was not met.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Line of the expectation in the file; 0 for what no expectation is about.
    pub line: usize,
    /// What was expected.
    pub expected: String,
    /// What came instead, in a sentence.
    pub came: String,
    /// The messages that did come around it.
    pub around: Vec<String>,
    /// Why it was expected.
    pub because: Option<String>,
}

/// Every expectation of `scenario` that `outcome` does not meet, and every layer refused against expectation.
pub fn judge(scenario: &Scenario, outcome: &Outcome) -> Vec<Failure> {
    let mut failures: Vec<Failure> = scenario
        .expectations
        .iter()
        .filter_map(|expectation| {
            let wrong = wrong(&expectation.what, outcome)?;
            Some(failure(scenario, expectation, wrong))
        })
        .collect();
    for (at, name, reasons) in &outcome.refused {
        let expected = scenario
            .expectations
            .iter()
            .any(|e| matches!(&e.what, What::Refused { layer, .. } if layer == name))
            || scenario.strangers.contains(name);
        if !expected {
            failures.push(Failure {
                line: 0,
                expected: format!("layer {name:?} joins at {at}"),
                came: format!("it was refused: {}", reasons.join("; ")),
                around: Vec::new(),
                because: None,
            });
        }
    }
    failures
}

/// What was expected, what came, and what came around it.
struct Wrong {
    expected: String,
    came: String,
    around: Vec<String>,
}

impl Wrong {
    fn new(expected: impl Into<String>, came: impl Into<String>) -> Wrong {
        Wrong {
            expected: expected.into(),
            came: came.into(),
            around: Vec::new(),
        }
    }
}

fn failure(scenario: &Scenario, expectation: &Expectation, wrong: Wrong) -> Failure {
    Failure {
        line: scenario.source.place(expectation.at.start).0,
        expected: wrong.expected,
        came: wrong.came,
        around: wrong.around,
        because: expectation.because.clone(),
    }
}

fn wrong(what: &What, outcome: &Outcome) -> Option<Wrong> {
    match what {
        What::Messages(expected) => messages(expected, outcome),
        What::Order { wires, window } => order(wires, *window, outcome),
        What::State { module, state, at } => {
            let is = outcome.seen[at].states.get(module).copied();
            let expected = format!("{module} is {state:?} {}", when(*at));
            match is {
                Some(is) if is == state => None,
                Some(is) => Some(Wrong::new(expected, format!("it is {is:?}"))),
                None => Some(Wrong::new(expected, "its layer is not here")),
            }
        }
        What::Halted { halted, cause, at } => halt(*halted, cause.as_deref(), *at, &outcome.seen[at]),
        What::Tap {
            from,
            to,
            holds,
            at,
            delivered,
            rejected,
        } => tap((from, to), *holds, *at, (*delivered, *rejected), outcome),
        What::Refused { layer, saying } => refused(layer, saying.as_deref(), outcome),
    }
}

fn when(at: Option<Span>) -> String {
    at.map_or("at the end".into(), |at| format!("at {at}"))
}

fn is_value(words: &Words, expected: &Messages) -> bool {
    let Some(value) = &expected.value else { return true };
    let pairs = words.iter().zip(value).take(expected.compared);
    pairs
        .into_iter()
        .all(|(came, wanted)| (came - wanted).abs() <= expected.tolerance)
}

fn messages(expected: &Messages, outcome: &Outcome) -> Option<Wrong> {
    let all = if expected.input {
        &outcome.inputs[&expected.port]
    } else {
        &outcome.wires[&expected.port]
    };
    let window = expected.window;
    let there: Vec<&(Span, Words)> = all.iter().filter(|(at, _)| window.holds(*at)).collect();
    let right = there
        .iter()
        .filter(|(_, words)| is_value(words, expected))
        .count();
    let met = match expected.rule {
        Rule::Some => right > 0,
        Rule::None => right == 0,
        Rule::Count(count) => count.holds(right as u64),
        Rule::All => !there.is_empty() && right == there.len(),
        Rule::Last => there.last().is_some_and(|(_, words)| is_value(words, expected)),
    };
    if met {
        return None;
    }
    let (port, kind) = (&expected.port, expected.kind);
    let value = expected.value.map(|words| shown(&words, kind));
    let of = value.as_ref().map_or(String::new(), |v| format!(" of {v}"));
    let on = if expected.input { "delivered to" } else { "on" };
    let wanted = match expected.rule {
        Rule::Some => format!("a message{of} {on} {port} {window}"),
        Rule::None => format!("no message{of} {on} {port} {window}"),
        Rule::Count(count) => format!("{count} messages{of} {on} {port} {window}"),
        Rule::All => format!(
            "every message {on} {port} is {} {window}",
            value.unwrap_or_default()
        ),
        Rule::Last => format!(
            "the newest message {on} {port} is {} {window}",
            value.unwrap_or_default()
        ),
    };
    let came = match (there.len(), expected.value.is_some()) {
        (0, _) => "none came then".to_string(),
        (n, false) => format!("{n} came"),
        (n, true) => format!("{n} came, {right} with that value"),
    };
    Some(Wrong {
        around: nearest(all, kind, window),
        ..Wrong::new(wanted, came)
    })
}

fn order(wires: &[String], window: Window, outcome: &Outcome) -> Option<Wrong> {
    let first = |wire: &String| {
        let mut messages = outcome.wires[wire].iter();
        messages.find(|(at, _)| window.holds(*at)).map(|(at, _)| *at)
    };
    let firsts: Vec<Option<Span>> = wires.iter().map(first).collect();
    let strictly = firsts.windows(2).all(|pair| match pair {
        [Some(a), Some(b)] => a < b,
        _ => false,
    });
    if strictly {
        return None;
    }
    let said = wires.iter().zip(&firsts).map(|(wire, at)| match at {
        Some(at) => format!("{:>12}  {wire}", at.to_string()),
        None => format!("{:>12}  {wire}", "never"),
    });
    Some(Wrong {
        around: said.collect(),
        ..Wrong::new(
            format!("{} one after the other {window}", wires.join(", ")),
            "their first messages came otherwise",
        )
    })
}

fn halt(halted: bool, cause: Option<&str>, at: Option<Span>, seen: &Seen) -> Option<Wrong> {
    let is = !seen.causes.names().is_empty();
    let wanted = cause.and_then(|c| CAUSES.iter().find(|(word, _)| *word == c));
    let right = wanted.is_none_or(|(_, cause)| seen.causes.has(*cause) == halted);
    if is == halted && right || (!halted && wanted.is_some() && right) {
        return None;
    }
    let word = if halted { "halted" } else { "not halted" };
    let by = cause.map_or(String::new(), |c| format!(" for {c:?}"));
    let came = if is {
        format!("it is halted: {}", seen.causes.names().join(", "))
    } else {
        "it is not halted".into()
    };
    Some(Wrong::new(format!("the body is {word}{by} {}", when(at)), came))
}

fn tap(
    (from, to): (&str, &str),
    holds: Option<bool>,
    at: Option<Span>,
    (delivered, rejected): (Option<Count>, Option<Count>),
    outcome: &Outcome,
) -> Option<Wrong> {
    let key = (from.to_string(), to.to_string());
    let find = |at: &Option<Span>| outcome.seen[at].taps.get(&key);
    let name = format!("{from} > {to}");
    let is = find(&at).is_some_and(|(_, holds)| *holds);
    if let Some(holds) = holds.filter(|holds| *holds != is) {
        let word = if holds { "holds" } else { "does not hold" };
        let came = match find(&at).and_then(|(tap, _)| tap.window) {
            Some(w) => {
                let said = w.stamp.since(daemon::virtual_run::BEGIN);
                format!(
                    "its newest message came at {said}, its window ends at {}",
                    said + w.time_constant
                )
            }
            None => "it has said nothing, or is not joined".into(),
        };
        return Some(Wrong::new(format!("the tap {name} {word} {}", when(at)), came));
    }
    let counts = find(&None).map(|(tap, _)| tap.counts).unwrap_or_default();
    for (wanted, what, is) in [
        (delivered, "delivers", counts.delivered),
        (rejected, "rejects", counts.rejected),
    ] {
        if let Some(wanted) = wanted.filter(|w| !w.holds(is)) {
            return Some(Wrong::new(
                format!("the tap {name} {what} {wanted} messages"),
                format!("it {what} {is}"),
            ));
        }
    }
    None
}

fn refused(layer: &str, saying: Option<&str>, outcome: &Outcome) -> Option<Wrong> {
    let reasons: Vec<&str> = outcome
        .refused
        .iter()
        .filter(|(_, name, _)| name == layer)
        .flat_map(|(_, _, reasons)| reasons.iter().map(String::as_str))
        .collect();
    let met = !reasons.is_empty() && saying.is_none_or(|s| reasons.iter().any(|r| r.contains(s)));
    if met {
        return None;
    }
    let expected = match saying {
        Some(saying) => format!("layer {layer:?} is refused, saying {saying:?}"),
        None => format!("layer {layer:?} is refused"),
    };
    let came = match reasons[..] {
        [] => "it was let in, or never asked".to_string(),
        _ => format!("it was refused: {}", reasons.join("; ")),
    };
    Some(Wrong::new(expected, came))
}
