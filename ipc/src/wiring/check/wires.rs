//! Wires: one writer for each input, read from the own level or below, into the own layer or the body.
//!
//! Must never let a lower level read from a higher one.

use super::{Checker, Draft};
use crate::wiring::creature::{BODY, PortName, Wire};
use crate::wiring::document::Placed;
use crate::wiring::rule::Rule;

impl Checker<'_> {
    pub(super) fn wires(&mut self, draft: &mut Draft<'_, '_>) {
        let wires = std::mem::take(&mut draft.raw.wires);
        for (from, to) in &wires {
            let (source, sink) = (self.port(from, true), self.port(to, false));
            let own = self
                .modules
                .get(&to.value.module)
                .map_or(to.value.module == BODY && self.host.is_none(), |known| {
                    known.layer == draft.index || to.value.module == BODY
                });
            if sink.is_some() && !own {
                self.not_own_input(to, draft.layer.level, sink.as_ref().and_then(|s| s.level));
            }
            if let (Some(source), Some(sink)) = (&source, &sink) {
                self.same_type(from, source, to, sink);
            }
            let level = source.as_ref().and_then(|s| s.level);
            if let Some(level) = level.filter(|l| *l > draft.layer.level) {
                let message = format!(
                    "{} is of level {level}, this layer is of level {}",
                    from.value, draft.layer.level
                );
                let help = "lower layers never rely on higher ones: expected a wire of this level or below";
                self.findings
                    .refuse(Rule::HigherSource, from.at.clone(), message, help);
            }
            if sink.is_some() && own {
                self.one_writer(from, to);
            }
            draft.layer.wires.push(Wire {
                from: from.value.clone(),
                to: to.value.clone(),
            });
        }
        // Where each wire comes from is asked again when circles are looked for.
        draft.raw.wires = wires;
    }

    fn not_own_input(&mut self, to: &Placed<PortName>, level: u8, other: Option<u8>) {
        let message = format!("{} is not an input of this layer", to.value);
        let help = if to.value.module == BODY {
            "commands to the body belong to the creature's own layers; expected an input of this layer".into()
        } else if other.is_some_and(|other| other < level) {
            format!(
                "to reach into a lower layer use a tap: suppress = [{{ from = \"...\", input = \"{}\", \
                 time_constant = \"...\" }}]",
                to.value
            )
        } else {
            "expected an input of this layer; a wire is declared by the layer that reads it".into()
        };
        self.findings
            .refuse(Rule::NotOwnInput, to.at.clone(), message, help);
    }

    fn one_writer(&mut self, from: &Placed<PortName>, to: &Placed<PortName>) {
        let Some(first) = self.writers.get(&to.value) else {
            self.writers
                .insert(to.value.clone(), (from.clone(), to.at.clone()));
            return;
        };
        let (first, input_at) = first;
        let also = (first.at.clone(), "first writer".into());
        if first.value == from.value {
            let message = format!("the wire {} -> {} stands here twice", from.value, to.value);
            let also = (input_at.clone(), "first here".into());
            let help = "remove one of the two";
            self.findings
                .refuse_both(Rule::DuplicateEntry, to.at.clone(), message, help, also);
            return;
        }
        let message = format!("{} is written by {} already", to.value, first.value);
        let help =
            "expected one writer for each input; a second one joins as a tap (suppress) from a higher level";
        self.findings
            .refuse_both(Rule::TwoWriters, to.at.clone(), message, help, also);
    }
}
