//! What a scenario file says must come of it.
//!
//! Must never judge: it reads what is expected, with every name resolved.

use std::ops::Range;

use daemon::gate::Causes;
use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::diagnostic::{Findings, one_of};
use ipc::wiring::document::{self as doc, DeValue, Keys, Placed, Spanned};

use crate::names::Names;
use crate::plan::{Count, Expectation, Messages, Rule, Said, What, Window};
use crate::values;

/// Words for the gate's causes, as files may say them.
pub(crate) const CAUSES: [(&str, Causes); 12] = [
    ("start", Causes::START),
    ("reflex", Causes::REFLEX),
    ("stale", Causes::STALE),
    ("stale command", Causes::STALE),
    ("unsound", Causes::UNSOUND),
    ("unsound command", Causes::UNSOUND),
    ("vital", Causes::VITAL),
    ("vital layer late", Causes::VITAL),
    ("overrun", Causes::OVERRUN),
    ("operator", Causes::EMERGENCY),
    ("emergency stop", Causes::EMERGENCY),
    ("shutdown", Causes::SHUTDOWN),
];

/// An expectation as read; the whole run is not known yet.
pub(crate) struct Item {
    at: Range<usize>,
    because: Option<String>,
    what: Option<What>,
    /// Every time named, with its place.
    pub(crate) times: Vec<(Span, Range<usize>)>,
    /// Highest level it is about.
    pub(crate) level: u8,
}

impl Item {
    /// The expectation, in a run that ends at `end`.
    pub(crate) fn finish(mut self, end: Span) -> Option<Expectation> {
        if let Some(What::Messages(Messages { window, .. }) | What::Order { window, .. }) = &mut self.what
            && window.said == Said::Whole
        {
            window.to = end;
        }
        Some(Expectation {
            at: self.at,
            because: self.because,
            what: self.what?,
        })
    }
}

/// Reads all expectations of the file.
pub(crate) fn read(list: Option<&Spanned<DeValue<'_>>>, names: &Names, findings: &mut Findings) -> Vec<Item> {
    let Some(list) = list else {
        let help = "add an [[expect]]: a scenario without one cannot fail";
        findings.error(0..0, "nothing is expected", help);
        return Vec::new();
    };
    let mut items = Vec::new();
    for value in doc::array(list, "expectations, each as an [[expect]] table", findings) {
        if let Some(keys) = doc::table(value, "this [[expect]]", findings) {
            items.push(Reading::new(keys, names, findings).item());
        }
    }
    items
}

struct Reading<'r, 't, 's> {
    keys: Keys<'t, 's>,
    names: &'r Names,
    findings: &'r mut Findings,
    times: Vec<(Span, Range<usize>)>,
    level: u8,
}

/// What an expectation can be about: the key that says so.
const SUBJECTS: [&str; 7] = ["wire", "input", "order", "module", "halted", "tap", "refused"];

impl<'r, 't, 's> Reading<'r, 't, 's> {
    fn new(keys: Keys<'t, 's>, names: &'r Names, findings: &'r mut Findings) -> Self {
        Reading {
            keys,
            names,
            findings,
            times: Vec::new(),
            level: 0,
        }
    }

    fn item(mut self) -> Item {
        let at = self.keys.at();
        let because = self.text("because", "a reason in words").map(|t| t.value);
        let given: Vec<&str> = SUBJECTS.into_iter().filter(|s| self.keys.has(s)).collect();
        let what = match given[..] {
            ["wire"] => self.messages("wire", false),
            ["input"] => self.messages("input", true),
            ["order"] => self.order(),
            ["module"] => self.state(),
            ["halted"] => self.halted(),
            ["tap"] => self.tap(),
            ["refused"] => self.refused(),
            _ => {
                let message = match given[..] {
                    [] => "an expectation about nothing".to_string(),
                    _ => format!("an expectation about {} at once", given.join(" and ")),
                };
                let help = format!("expected one of {}", SUBJECTS.join(", "));
                self.findings.error(at.clone(), message, help);
                return self.done(at, because, None, false);
            }
        };
        self.done(at, because, what, true)
    }

    /// The item; of an expectation about nothing nobody knows which keys it may have.
    fn done(self, at: Range<usize>, because: Option<String>, what: Option<What>, known: bool) -> Item {
        if known {
            self.keys.finish(self.findings);
        }
        Item {
            at,
            because,
            what,
            times: self.times,
            level: self.level,
        }
    }

    fn text(&mut self, key: &'static str, expected: &str) -> Option<Placed<String>> {
        doc::text(self.keys.take(key)?, expected, self.findings)
    }

    fn span(&mut self, key: &'static str) -> Option<Span> {
        doc::span(self.keys.take(key)?, false, self.findings)
    }

    fn bit(&mut self, key: &'static str) -> Option<bool> {
        doc::bit(self.keys.take(key)?, self.findings)
    }

    /// A moment of the run.
    fn moment(&mut self) -> Option<Span> {
        let value = self.keys.take("at")?;
        let span = doc::span(value, false, self.findings)?;
        self.times.push((span, value.span()));
        Some(span)
    }

    fn window(&mut self) -> Window {
        let tolerance = self.span("tolerance_time");
        let at = self.moment();
        let within = self.keys.take("within");
        if let (Some(within), true) = (within, at.is_some()) {
            let help = "expected either at = \"...\" or within = [\"...\", \"...\"]";
            self.findings
                .error(within.span(), "a moment and a window at once", help);
        }
        if let Some(at) = at {
            let off = tolerance.unwrap_or_default();
            return Window {
                from: Span(at.0.saturating_sub(off.0)),
                to: at + off + Span(1),
                said: Said::At(at, off),
            };
        }
        if let Some(within) = within {
            let ends = values::times(within, self.findings);
            if let [(from, first), (to, last)] = &ends[..] {
                if from >= to {
                    let help = "expected a later second time: the window begins at the first and ends before the second";
                    self.findings
                        .error(last.clone(), "the window ends before it begins", help);
                }
                self.times.push((*from, first.clone()));
                // The end is not in the window, and may be the end of the run.
                self.times.push((Span(to.0.saturating_sub(1)), last.clone()));
                return Window {
                    from: *from,
                    to: *to,
                    said: Said::Within,
                };
            }
            let help = "expected two times such as [\"1s\", \"2s\"]";
            self.findings.error(within.span(), "not a window", help);
        }
        Window {
            from: Span::ZERO,
            to: Span(u64::MAX),
            said: Said::Whole,
        }
    }

    fn port(&mut self, name: &Placed<String>, input: bool) -> Option<Kind> {
        let (known, what) = if input {
            (&self.names.inputs, "input")
        } else {
            (&self.names.outputs, "wire")
        };
        let found = self
            .names
            .find(known, what, &name.value, name.at.clone(), self.findings);
        let (kind, level) = found?;
        self.level = self.level.max(level);
        Some(kind)
    }

    fn messages(&mut self, key: &'static str, input: bool) -> Option<What> {
        let name = self.text(key, "a port such as \"sonar.map\"");
        let window = self.window();
        let tolerance = self.keys.take("tolerance");
        let tolerance = tolerance.and_then(|v| doc::number(v, 0.0, f64::MAX, self.findings));
        let value = self.keys.take("value");
        let rule = self.rule(value.is_some());
        let name = name?;
        let kind = self.port(&name, input);
        let value = match (value, kind) {
            (Some(value), Some(kind)) => Some(values::value(value, kind, self.findings)?),
            _ => None,
        };
        Some(What::Messages(Messages {
            port: name.value,
            input,
            kind: kind?,
            window,
            value: value.map(|(words, _)| words),
            compared: value.map_or(0, |(_, n)| n),
            tolerance: tolerance.unwrap_or(1e-9),
            rule,
        }))
    }

    fn rule(&mut self, has_value: bool) -> Rule {
        let mut rules = Vec::new();
        let count = self.count("count");
        if let Some(count) = count {
            rules.push(("count", Rule::Count(count)));
        }
        for (key, rule) in [("none", Rule::None), ("all", Rule::All), ("last", Rule::Last)] {
            let Some(value) = self.keys.take(key) else {
                continue;
            };
            match doc::bit(value, self.findings) {
                Some(true) => {
                    rules.push((key, rule));
                    if !has_value && rule != Rule::None {
                        let message = format!("{key} of no value");
                        self.findings.error(value.span(), message, "add value = ...");
                    }
                }
                Some(false) => {
                    let message = format!("{key} = false says nothing");
                    self.findings.error(value.span(), message, "remove it");
                }
                None => {}
            }
        }
        match rules[..] {
            [] => Rule::Some,
            [(_, rule)] => rule,
            _ => {
                let keys: Vec<&str> = rules.iter().map(|(key, _)| *key).collect();
                let message = format!("{} at once", keys.join(" and "));
                let help = "expected one of none, count, all, last; write an [[expect]] for each";
                self.findings.error(self.keys.at(), message, help);
                Rule::Some
            }
        }
    }

    /// A number, or `{ min = 2, max = 4 }`.
    fn count(&mut self, key: &'static str) -> Option<Count> {
        const MOST: u64 = i64::MAX as u64;
        let value = self.keys.take(key)?;
        if !matches!(value.get_ref(), DeValue::Table(_)) {
            let n = doc::whole(value, 0, MOST, self.findings)?;
            return Some(Count { min: n, max: n });
        }
        let mut keys = doc::table(value, format!("this {key}"), self.findings)?;
        let min = keys
            .take("min")
            .and_then(|v| doc::whole(v, 0, MOST, self.findings));
        let max = keys
            .take("max")
            .and_then(|v| doc::whole(v, 0, MOST, self.findings));
        keys.finish(self.findings);
        let count = Count {
            min: min.unwrap_or(0),
            max: max.unwrap_or(u64::MAX),
        };
        if count.min > count.max || (min.is_none() && max.is_none()) {
            let help = "expected { min = ..., max = ... }, or one of them, min not above max";
            self.findings
                .error(value.span(), "not a number of messages", help);
        }
        Some(count)
    }

    fn order(&mut self) -> Option<What> {
        let list = self.keys.take("order")?;
        let window = self.window();
        let mut wires = Vec::new();
        for item in doc::array(list, "wires such as [\"a.out\", \"b.out\"]", self.findings) {
            let Some(name) = doc::text(item, "a wire such as \"a.out\"", self.findings) else {
                continue;
            };
            self.port(&name, false);
            wires.push(name.value);
        }
        if wires.len() < 2 {
            self.findings.error(
                list.span(),
                "an order of less than two",
                "expected two wires or more",
            );
        }
        Some(What::Order { wires, window })
    }

    fn state(&mut self) -> Option<What> {
        let module = self.text("module", "the name of a module");
        let at = self.moment();
        let state = self.keys.need("state", self.findings);
        let state = state.and_then(|v| doc::text(v, "the name of a state", self.findings));
        let module = module?;
        let modules = &self.names.modules;
        let place = module.at.clone();
        let level = self
            .names
            .find(modules, "module", &module.value, place, self.findings);
        self.level = self.level.max(level?);
        Some(What::State {
            module: module.value,
            state: state?.value,
            at,
        })
    }

    fn halted(&mut self) -> Option<What> {
        let halted = self.bit("halted");
        let at = self.moment();
        let cause = self.text("cause", "a cause such as \"operator\"");
        if let Some(cause) = &cause
            && !CAUSES.iter().any(|(word, _)| *word == cause.value)
        {
            let help = one_of("cause", &cause.value, CAUSES.iter().map(|(word, _)| *word));
            let message = format!("unknown cause {:?}", cause.value);
            self.findings.error(cause.at.clone(), message, help);
        }
        Some(What::Halted {
            halted: halted?,
            cause: cause.map(|c| c.value),
            at,
        })
    }

    fn tap(&mut self) -> Option<What> {
        let name = self.text("tap", "a tap such as \"wander.heading > turn.heading\"");
        let at = self.moment();
        let holds = self.bit("holds");
        let (delivered, rejected) = (self.count("delivered"), self.count("rejected"));
        if holds.is_none() && delivered.is_none() && rejected.is_none() {
            let help = "add holds = ..., delivered = ... or rejected = ...";
            self.findings
                .error(self.keys.at(), "nothing is expected of the tap", help);
        }
        let name = name?;
        let ends: Vec<&str> = name.value.split('>').map(str::trim).collect();
        let [from, to] = ends[..] else {
            let help = "expected \"module.output > module.port\"";
            self.findings.error(name.at, "a tap without an arrow", help);
            return None;
        };
        let key = format!("{from} > {to}");
        let level = self
            .names
            .find(&self.names.taps, "tap", &key, name.at.clone(), self.findings);
        self.level = self.level.max(level?);
        Some(What::Tap {
            from: from.into(),
            to: to.into(),
            holds,
            at,
            delivered,
            rejected,
        })
    }

    fn refused(&mut self) -> Option<What> {
        let layer = self.text("refused", "the name of a manifest");
        let saying = self.text("saying", "a part of the reason");
        let layer = layer?;
        let manifests = &self.names.manifests;
        let place = layer.at.clone();
        self.names
            .find(manifests, "manifest", &layer.value, place, self.findings)?;
        Some(What::Refused {
            layer: layer.value,
            saying: saying.map(|s| s.value),
        })
    }
}
