//! Taps: from an output of the declaring layer, downward, and never into the halt channel.
//!
//! Must never let a tap through that points to its own level or above.

use super::{Checker, Draft};
use crate::wire::TAPS_MAX;
use crate::wiring::creature::{BODY, How, PortName, Tap};
use crate::wiring::document::Placed;
use crate::wiring::rule::Rule;

use super::ports::Found;

impl Checker<'_> {
    pub(super) fn taps(&mut self, draft: &mut Draft<'_, '_>, reflexes: &[Placed<PortName>]) {
        let mut seen: std::collections::HashMap<(How, PortName, PortName), Placed<PortName>> =
            std::collections::HashMap::new();
        for tap in &draft.raw.taps {
            let source = tap.from.as_ref().and_then(|from| self.tap_source(draft, from));
            let target = tap
                .to
                .as_ref()
                .and_then(|to| Some((to, self.port(to, tap.how == How::Inhibit)?)));
            if let Some((to, target)) = &target {
                self.tap_target(draft.layer.level, tap.how, to, target, reflexes);
            }
            if let (How::Suppress, Some((from, source)), Some((to, target))) = (tap.how, &source, &target) {
                self.same_type(from, source, to, target);
            }
            let (Some(from), Some(to), Some(time_constant)) = (&tap.from, &tap.to, &tap.time_constant) else {
                continue;
            };
            let key = (tap.how, from.value.clone(), to.value.clone());
            if let Some(first) = seen.insert(key, to.clone()) {
                let message = format!("{} taps {} twice", from.value, to.value);
                let also = (first.at, "first here".into());
                let help = "remove one of the two";
                self.findings
                    .refuse_both(Rule::DuplicateEntry, to.at.clone(), message, help, also);
            }
            draft.layer.taps.push(Tap {
                how: tap.how,
                from: from.value.clone(),
                to: to.value.clone(),
                time_constant: time_constant.value,
            });
        }
    }

    fn tap_source<'p>(
        &mut self,
        draft: &Draft<'_, '_>,
        from: &'p Placed<PortName>,
    ) -> Option<(&'p Placed<PortName>, Found)> {
        let source = self.port(from, true)?;
        if source.layer != Some(draft.index) {
            let message = format!("{} is not an output of this layer", from.value);
            let help =
                "expected an output of one of this layer's modules: a layer taps with its own messages";
            self.findings
                .refuse(Rule::NotOwnOutput, from.at.clone(), message, help);
        }
        Some((from, source))
    }

    fn tap_target(
        &mut self,
        level: u8,
        how: How,
        to: &Placed<PortName>,
        target: &Found,
        reflexes: &[Placed<PortName>],
    ) {
        if let Some(other) = target.level.filter(|other| *other >= level) {
            let message = format!("{} is of level {other}, this layer is of level {level}", to.value);
            let help = if level == 0 {
                "taps point to a lower level, and there is none below 0: put this layer on a higher level"
                    .into()
            } else {
                format!("taps point to a lower level: expected a port of a level below {level}")
            };
            self.findings
                .refuse(Rule::TapUpward, to.at.clone(), message, help);
        }
        if how == How::Inhibit && to.value.module == BODY {
            let message = format!("{} is a sensor", to.value);
            let help = "nobody may blind the layers below: expected an output of a module";
            self.findings
                .refuse(Rule::SensorTap, to.at.clone(), message, help);
        }
        if self.is_reflex(&to.value, reflexes) || self.feeds_reflex(&to.value, reflexes) {
            self.halt_channel(to);
        }
        let count = self
            .tapped
            .entry((how == How::Suppress, to.value.clone()))
            .or_default();
        *count += 1;
        if *count == TAPS_MAX + 1 {
            let message = format!("there are more than {TAPS_MAX} taps on {}", to.value);
            let help = format!("expected at most {TAPS_MAX} taps on a port");
            self.findings
                .refuse(Rule::TooManyTaps, to.at.clone(), message, help);
        }
    }

    /// Whether an output is part of the halt channel.
    pub(super) fn is_reflex(&self, name: &PortName, reflexes: &[Placed<PortName>]) -> bool {
        let whole = name.to_string();
        reflexes.iter().any(|r| r.value == *name) || self.host.is_some_and(|h| h.reflexes.contains(&whole))
    }

    /// Whether a port belongs to a module that a reflex depends on, from the sensors up: who deafens or blinds
    /// such a module has stopped the reflex without touching it.
    pub(super) fn feeds_reflex(&self, name: &PortName, reflexes: &[Placed<PortName>]) -> bool {
        let mut channel: Vec<&str> = reflexes.iter().map(|r| r.value.module.as_str()).collect();
        let mut next = 0;
        while next < channel.len() {
            let module = channel[next];
            next += 1;
            let into = self.writers.iter().filter(|(to, _)| to.module == module);
            for (_, (from, _)) in into {
                let before = from.value.module.as_str();
                if before != BODY && !channel.contains(&before) {
                    channel.push(before);
                }
            }
        }
        channel.contains(&name.module.as_str())
    }

    pub(super) fn halt_channel(&mut self, to: &Placed<PortName>) {
        let message = format!("{} is part of the halt channel", to.value);
        let help = match self.host {
            None => "nothing taps the halt channel: remove this tap, or take the output out of [halt] reflex",
            Some(_) => "nothing taps the halt channel: remove this tap",
        };
        self.findings
            .refuse(Rule::HaltChannel, to.at.clone(), message, help);
    }
}
