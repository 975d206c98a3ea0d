//! Manifests: a layer from outside brings a layer and nothing else, and keeps to the creature's policy.
//!
//! Must never be the only judge: the daemon asks [`policy`](crate::wiring::policy) again when the layer comes.

use super::{Checker, Draft};
use crate::wiring::creature::{BODY, How, PortName};
use crate::wiring::directory::Directory;
use crate::wiring::document::Placed;
use crate::wiring::policy::{self, Claim, ClaimedTap, Part};
use crate::wiring::read::Parts;
use crate::wiring::rule::Rule;

impl Checker<'_> {
    pub(super) fn manifest_shape(&mut self, parts: &Parts<'_, '_>) {
        let foreign = [
            ("[body]", parts.body.as_ref().map(|b| &b.at)),
            ("[halt]", parts.halt.as_ref().map(|h| &h.at)),
            ("[executor]", parts.executor.as_ref().map(|e| &e.at)),
            ("seed", parts.seed.as_ref().map(|s| &s.at)),
        ];
        for (what, at) in foreign {
            let Some(at) = at else { continue };
            let message = format!("a manifest has no {what}");
            let help = "that belongs to the creature's own file: remove it here";
            self.findings
                .refuse(Rule::NotInManifest, at.clone(), message, help);
        }
        for (key, at) in parts.outsiders.iter().flat_map(|o| &o.limits) {
            let message = format!("the [outsiders] of a manifest have no {key:?}");
            let help =
                "whom it lets in and how much is for the creature's own file: expected \"read\" and \"tap\"";
            self.findings
                .refuse(Rule::NotInManifest, at.clone(), message, help);
        }
        for layer in parts.layers.iter().skip(1) {
            let help = "a layer process runs one layer: put each into a manifest of its own";
            let message = "a manifest has one [[layer]]";
            self.findings
                .refuse(Rule::NotInManifest, layer.at.clone(), message, help);
        }
        for vital in parts.layers.iter().filter_map(|l| l.vital.as_ref()) {
            if vital.value {
                let help = "every layer from outside may go at any time: remove this, or put the layer into the creature's file";
                let message = "a layer from outside cannot be vital";
                self.findings
                    .refuse(Rule::NotInManifest, vital.at.clone(), message, help);
            }
        }
    }

    /// Whether it is for this file to open a port: a manifest opens those of its own modules.
    pub(super) fn opens(&self, name: &Placed<PortName>) -> bool {
        self.host.is_none() || self.modules.contains_key(&name.value.module)
    }

    /// A layer opens its own ports to others, and nobody else's.
    pub(super) fn opens_its_own(&mut self, opened: &[Placed<PortName>]) {
        for name in opened {
            if self.opens(name) {
                continue;
            }
            let message = format!("{} is not a port of this layer", name.value);
            let help = "expected a port of one of its modules: what else is open is for its owner to say";
            self.findings
                .refuse(Rule::NotInManifest, name.at.clone(), message, help);
        }
    }

    /// What the policy of the creature says to this manifest.
    pub(super) fn policy(&mut self, drafts: &[Draft<'_, '_>], host: &Directory) {
        for draft in drafts {
            let own = |module: &str| self.modules.contains_key(module);
            // What is not there at all was complained of.
            // Nor do sensors have to be closed to taps one by one.
            let there = |how: How, to: &PortName| {
                let whole = to.to_string();
                let ports = if how == How::Suppress {
                    &host.inputs
                } else {
                    &host.outputs
                };
                (to.module != BODY || how == How::Suppress) && ports.iter().any(|p| p.name == whole)
            };
            let outside: Vec<_> = draft
                .raw
                .wires
                .iter()
                .map(|(from, _)| from)
                .filter(|from| !own(&from.value.module))
                .collect();
            let reads: Vec<String> = outside.iter().map(|from| from.value.to_string()).collect();
            let taps: Vec<_> = draft
                .raw
                .taps
                .iter()
                .filter_map(|t| Some((t.how, t.to.as_ref()?, t.time_constant.as_ref()?)))
                .filter(|(how, to, _)| !own(&to.value.module) && there(*how, &to.value))
                .collect();
            let claim = Claim {
                layer: &draft.layer.name,
                level: draft.layer.level,
                reads: reads.iter().map(String::as_str).collect(),
                taps: taps
                    .iter()
                    .map(|(how, to, time_constant)| ClaimedTap {
                        how: *how,
                        to: to.value.to_string(),
                        time_constant: time_constant.value,
                    })
                    .collect(),
            };
            for breach in policy::breaches(host, &claim) {
                let at = match breach.part {
                    Part::Layer => draft
                        .raw
                        .name
                        .as_ref()
                        .map_or(draft.raw.at.clone(), |n| n.at.clone()),
                    Part::Level => draft.raw.at.clone(),
                    Part::Read(i) => outside[i].at.clone(),
                    Part::Tap(i) => taps[i].1.at.clone(),
                    Part::TimeConstant(i) => taps[i].2.at.clone(),
                };
                // An inhibited reflex was found with the other taps.
                let known = breach.rule == Rule::HaltChannel
                    && matches!(breach.part, Part::Tap(i) if taps[i].0 == How::Inhibit);
                if !known {
                    self.findings.refuse(breach.rule, at, breach.message, breach.help);
                }
            }
        }
    }
}
