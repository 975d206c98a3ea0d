//! Taking the keys of a table as its grammar says: the grammar's types, ranges and needs, and no others.
//!
//! Must never take a key that the grammar does not have, nor leave one of the grammar's untaken.

use toml::Spanned;
use toml::de::DeValue;

use crate::clock::Span;
use crate::wiring::creature::PortName;
use crate::wiring::diagnostic::Findings;
use crate::wiring::document::{self as doc, Keys, Placed};
use crate::wiring::grammar::{Grammar, Key, Value};
use crate::wiring::rule::Rule;

use super::port;

/// A table of one grammar being read.
pub(super) struct Taking<'t, 's, 'f> {
    pub(super) keys: Keys<'t, 's>,
    pub(super) findings: &'f mut Findings,
    grammar: &'static Grammar,
    taken: Vec<&'static str>,
}

impl<'t, 's, 'f> Taking<'t, 's, 'f> {
    /// The table `value`, if it is one.
    pub(super) fn table(
        value: &'t Spanned<DeValue<'s>>,
        grammar: &'static Grammar,
        findings: &'f mut Findings,
    ) -> Option<Self> {
        let keys = doc::table(value, grammar.what, findings)?;
        Some(Taking::new(keys, grammar, findings))
    }

    pub(super) fn new(keys: Keys<'t, 's>, grammar: &'static Grammar, findings: &'f mut Findings) -> Self {
        Taking {
            keys,
            findings,
            grammar,
            taken: Vec::new(),
        }
    }

    fn key(&mut self, name: &str) -> (&'static Key, Option<&'t Spanned<DeValue<'s>>>) {
        let key = self
            .grammar
            .key(name)
            .unwrap_or_else(|| panic!("{} has no key {name:?} in its grammar", self.grammar.what));
        self.taken.push(key.name);
        // Where a line could not be read, a key may be missing for that reason.
        let value = self.keys.take(key.name);
        if value.is_none() && key.needed && !self.findings.has_lost_lines() {
            let message = format!("{} has no {:?}", self.keys.what(), key.name);
            let help = format!("add {} = {}: {}", key.name, key.takes.example(), key.about);
            self.findings
                .refuse(Rule::MissingKey, self.keys.at(), message, help);
        }
        (key, value)
    }

    /// The value of `name` as it stands.
    pub(super) fn raw(&mut self, name: &str) -> Option<&'t Spanned<DeValue<'s>>> {
        self.key(name).1
    }

    /// Leaves out a key that this place does not need.
    pub(super) fn unneeded<T>(&mut self, name: &'static str) -> Option<T> {
        self.taken.push(name);
        let _ = self.keys.take(name);
        None
    }

    pub(super) fn name(&mut self, name: &str) -> Option<Placed<String>> {
        let (key, value) = self.key(name);
        port::name(value?, &format!("a name: {}", key.about), self.findings)
    }

    pub(super) fn text(&mut self, name: &str, expected: &str) -> Option<Placed<String>> {
        let value = self.raw(name)?;
        doc::text(value, expected, self.findings)
    }

    pub(super) fn whole(&mut self, name: &str) -> Option<Placed<u64>> {
        let (key, value) = self.key(name);
        let Value::Whole { low, high } = key.takes else {
            panic!("{name:?} is not a whole number in its grammar");
        };
        let value = value?;
        placed(value, doc::whole(value, low, high, self.findings))
    }

    pub(super) fn number(&mut self, name: &str) -> Option<Placed<f64>> {
        let (key, value) = self.key(name);
        let Value::Number { low, high } = key.takes else {
            panic!("{name:?} is not a number in its grammar");
        };
        let value = value?;
        placed(value, doc::number(value, low, high, self.findings))
    }

    pub(super) fn time(&mut self, name: &str) -> Option<Placed<Span>> {
        let (key, value) = self.key(name);
        let Value::Time { positive } = key.takes else {
            panic!("{name:?} is not a time in its grammar");
        };
        let value = value?;
        placed(value, doc::span(value, positive, self.findings))
    }

    pub(super) fn bit(&mut self, name: &str) -> Option<Placed<bool>> {
        let value = self.raw(name)?;
        placed(value, doc::bit(value, self.findings))
    }

    /// The index of the word given.
    pub(super) fn word(&mut self, name: &str) -> Option<Placed<usize>> {
        let (key, value) = self.key(name);
        let Value::Word(words) = key.takes else {
            panic!("{name:?} is not a word in its grammar");
        };
        let value = value?;
        placed(value, doc::word(value, name, words, self.findings))
    }

    pub(super) fn port(&mut self, name: &str) -> Option<Placed<PortName>> {
        let value = self.raw(name)?;
        port::value(value, self.findings)
    }

    pub(super) fn ports(&mut self, name: &str) -> Vec<Placed<PortName>> {
        self.raw(name)
            .map_or(Vec::new(), |list| port::list(list, self.findings))
    }

    /// Hands back the table for the keys that its kind takes.
    pub(super) fn rest(self) -> Keys<'t, 's> {
        self.assert_whole();
        self.keys
    }

    /// Notes every key that the grammar does not have.
    pub(super) fn finish(self) {
        self.assert_whole();
        // A wire may stand under a misspelt key.
        if self.keys.has_others() {
            self.findings.lose_wire();
        }
        self.keys.finish(self.findings);
    }

    fn assert_whole(&self) {
        for key in self.grammar.keys {
            assert!(
                self.taken.contains(&key.name),
                "{:?} of {} is never read",
                key.name,
                self.grammar.what
            );
        }
    }
}

fn placed<T>(value: &Spanned<DeValue<'_>>, read: Option<T>) -> Option<Placed<T>> {
    let at = value.span();
    read.map(|value| Placed { value, at })
}
