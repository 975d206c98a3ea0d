//! Names: layers and modules are called differently, kinds are known, parameters are what the kind takes.
//!
//! Must never forget a name for an error in what it stands for: wires that use it are not wrong for that.

use std::collections::HashMap;

use super::{Checker, Draft, Known};
use crate::clock::Span;
use crate::wire::WIRES_MAX;
use crate::wiring::catalog::{Declaration, Setting, Takes};
use crate::wiring::creature::{BODY, Body, Layer, Module, Wake};
use crate::wiring::document::{self as doc, Keys, Placed};
use crate::wiring::read::{RawBody, RawLayer, RawModule};
use crate::wiring::rule::Rule;

/// How long before the beat a layer with `wake = "spin"` begins to spin, if it does not say.
pub(super) const SPIN: Span = Span::micros(50);

impl Checker<'_> {
    pub(super) fn take_body(&mut self, raw: Option<RawBody<'_, '_>>) -> Option<Body> {
        let raw = raw?;
        if self.host.is_some() {
            return None;
        }
        let declaration = raw.kind.as_ref().and_then(|kind| self.kind(kind, true));
        self.modules.insert(
            BODY.into(),
            Known {
                declaration,
                level: 0,
                layer: usize::MAX,
                at: raw.at,
            },
        );
        let settings = self.settings(raw.settings, declaration?);
        self.outputs += declaration?.outputs.len();
        Some(Body {
            declaration: declaration?,
            period: raw.period.map_or(Span::millis(20), |p| p.value),
            settings,
        })
    }

    fn kind(&mut self, given: &Placed<String>, body: bool) -> Option<&'static Declaration> {
        let (what, known) = if body {
            ("kind of body", &self.body_kinds)
        } else {
            ("kind of module", &self.module_kinds)
        };
        if let Some(found) = known.get(given.value.as_str()) {
            return Some(*found);
        }
        let mut help = self
            .findings
            .one_of(what, &given.value, known.keys().copied())
            .replace("kind of modules", "kinds of module")
            .replace("kind of bodys", "kinds of body");
        if !body && known.len() > 12 {
            help.push_str("; `subsumectl modules` lists them");
        }
        let message = format!("unknown {what} {:?}", given.value);
        self.findings
            .refuse(Rule::UnknownKind, given.at.clone(), message, help);
        None
    }

    fn settings(&mut self, mut keys: Keys<'_, '_>, declaration: &'static Declaration) -> Vec<Setting> {
        let mut settings = Vec::new();
        for parameter in declaration.parameters {
            if let Takes::File { .. } = parameter.takes {
                settings.push(Setting::File(self.attached(&mut keys, parameter)));
                continue;
            }
            let f = &mut self.findings;
            let given = match parameter.takes.default() {
                Some(_) => keys.take(parameter.name),
                None => keys.need(parameter.name, f),
            };
            let read = given.and_then(|v| match parameter.takes {
                Takes::Number { low, high, .. } => doc::number(v, low, high, f).map(Setting::Number),
                Takes::Span { .. } => doc::span(v, true, f).map(Setting::Span),
                Takes::Bit { .. } => doc::bit(v, f).map(Setting::Bit),
                Takes::Word { words, .. } => {
                    doc::word(v, parameter.name, words, f).map(|i| Setting::Text(words[i].into()))
                }
                Takes::Numbers { low, high, most, .. } => {
                    let items = doc::list(v, "numbers", most, f);
                    let numbers = items.iter().filter_map(|n| doc::number(n, low, high, f));
                    Some(Setting::Numbers(numbers.collect()))
                }
                Takes::Spans { most, .. } => {
                    let items = doc::list(v, "times such as [\"20ms\"]", most, f);
                    let spans = items.iter().filter_map(|s| doc::span(s, false, f));
                    Some(Setting::Spans(spans.collect()))
                }
                Takes::File { .. } => None,
            });
            settings.push(read.or(parameter.takes.default()).unwrap_or(Setting::Bit(false)));
        }
        keys.finish(&mut self.findings);
        settings
    }

    pub(super) fn layer_names(&mut self, layers: &[RawLayer<'_, '_>]) {
        let mut seen: HashMap<&str, &Placed<String>> = HashMap::new();
        for name in layers.iter().filter_map(|l| l.name.as_ref()) {
            if let Some(first) = seen.insert(&name.value, name) {
                let message = format!("there are two layers called {:?}", name.value);
                let help = "expected a name of its own for each layer";
                let also = (first.at.clone(), "first here".into());
                self.findings
                    .refuse_both(Rule::DuplicateLayer, name.at.clone(), message, help, also);
            }
        }
    }

    pub(super) fn draft<'t, 's>(&mut self, index: usize, mut raw: RawLayer<'t, 's>) -> Draft<'t, 's> {
        let mut modules = Vec::new();
        for module in std::mem::take(&mut raw.modules) {
            modules.extend(self.module(index, raw.level.unwrap_or(0), module));
        }
        let spin = raw.spin.as_ref().map_or(SPIN, |s| s.value);
        let layer = Layer {
            name: raw.name.as_ref().map_or(String::new(), |n| n.value.clone()),
            level: raw.level.unwrap_or(0),
            period: raw.period.unwrap_or(Span::secs(1)),
            phase: raw.phase.as_ref().map_or(Span::ZERO, |p| p.value),
            priority: raw.priority.as_ref().map(|p| p.value),
            cpu: raw.cpu.as_ref().map(|c| c.value),
            overrun: raw.overrun,
            vital: raw.vital.as_ref().is_some_and(|v| v.value),
            group: raw.group.as_ref().map(|g| g.value.clone()),
            wake: if raw.spins { Wake::Spin(spin) } else { Wake::Sleep },
            modules,
            wires: Vec::new(),
            taps: Vec::new(),
        };
        Draft { index, raw, layer }
    }

    fn module(&mut self, layer: usize, level: u8, raw: RawModule<'_, '_>) -> Option<Module> {
        let name = raw.name.value.clone();
        let mut declaration = None;
        let mut settings = Vec::new();
        if let Some((kind, keys)) = raw.kind {
            declaration = self.kind(&kind, false);
            if let Some(declaration) = declaration {
                settings = self.settings(keys, declaration);
            }
        }
        let at = raw.name.at.clone();
        if name == BODY {
            let help = "\"body\" stands for the body on wires: expected another name";
            self.findings
                .refuse(Rule::ReservedName, at, "a module is called \"body\"", help);
            return None;
        }
        let help = "expected a name of its own for each module of the creature";
        if let Some(host) = self.host.filter(|h| h.has_module(&name)) {
            let message = format!("the creature {:?} has a module {name:?} already", host.creature);
            self.findings.refuse(Rule::DuplicateModule, at, message, help);
            return None;
        }
        if let Some(first) = self.modules.get(&name) {
            let message = format!("there are two modules called {name:?}");
            let also = (first.at.clone(), "first here".into());
            self.findings
                .refuse_both(Rule::DuplicateModule, at, message, help, also);
            return None;
        }
        if let Some(declaration) = declaration {
            let before = self.outputs;
            self.outputs += declaration.outputs.len();
            if before <= WIRES_MAX && self.outputs > WIRES_MAX {
                let message = format!("with this module there are {} outputs", self.outputs);
                let help = format!("expected at most {WIRES_MAX} in a creature");
                self.findings
                    .refuse(Rule::TooManyWires, at.clone(), message, help);
            }
        }
        let known = Known {
            declaration,
            level,
            layer,
            at,
        };
        self.modules.insert(name.clone(), known);
        declaration.map(|declaration| Module {
            name,
            declaration,
            settings,
        })
    }
}
