//! The halt channel and `[outsiders]`: what stops the body, and what processes outside may do.
//!
//! Must never open the halt channel to anybody.

use std::collections::HashMap;
use std::hash::Hash;
use std::ops::Range;
use std::path::PathBuf;

use super::Checker;
use crate::clock::Span;
use crate::message::Kind;
use crate::wiring::creature::{BODY, Outsiders, PortName, Reads};
use crate::wiring::document::Placed;
use crate::wiring::read::RawOutsiders;
use crate::wiring::rule::Rule;

impl Checker<'_> {
    pub(super) fn reflexes(&mut self, given: &[Placed<PortName>]) -> Vec<PortName> {
        self.each_once("reflex", given);
        for name in given {
            let Some(found) = self.port(name, true) else {
                continue;
            };
            if found.kind != Kind::Pulse {
                let message = format!("{} carries {}", name.value, found.kind);
                let help = "expected an output that carries a pulse";
                self.findings
                    .refuse(Rule::BadReflex, name.at.clone(), message, help);
            }
            if found.level != Some(0) {
                let (message, help) = match found.level {
                    Some(level) => (
                        format!("{} is of level {level}", name.value),
                        "expected an output of level 0: the reflex works with every other layer gone",
                    ),
                    None => (
                        format!("{} is a sensor", name.value),
                        "expected an output of a module of level 0",
                    ),
                };
                self.findings
                    .refuse(Rule::BadReflex, name.at.clone(), message, help);
            }
        }
        values(given)
    }

    pub(super) fn watchdog_device(&mut self, given: Option<&Placed<String>>) -> Option<PathBuf> {
        let given = given?;
        let path = PathBuf::from(&given.value);
        if !path.is_absolute() || given.value.contains('\0') {
            let message = format!("{:?} is not an absolute path", given.value);
            let help = "expected the path of a watchdog device such as \"/dev/watchdog\"";
            self.findings
                .refuse(Rule::BadPath, given.at.clone(), message, help);
        }
        Some(path)
    }

    pub(super) fn outsiders(&mut self, raw: &RawOutsiders, reflexes: &[Placed<PortName>]) -> Outsiders {
        self.each_once("port", &raw.taps);
        if self.host.is_some() {
            self.opens_its_own(&raw.taps);
            self.opens_its_own(raw.reads.as_deref().unwrap_or_default());
        }
        for name in &raw.taps {
            if self.opens(name) {
                self.open_tap(name, reflexes);
            }
        }
        if let Some(reads) = &raw.reads {
            self.each_once("port", reads);
            for name in reads {
                if self.opens(name) {
                    let _ = self.port(name, true);
                }
            }
        }
        let whole = |given: &Option<Placed<u64>>, default: u64| given.as_ref().map_or(default, |g| g.value);
        let span = |given: &Option<Placed<Span>>, default| given.as_ref().map_or(default, |g| g.value);
        let shortest = span(&raw.time_constant_min, Span::ZERO);
        let longest = span(&raw.time_constant_max, Span::secs(60));
        let place = raw.time_constant_min.as_ref().or(raw.time_constant_max.as_ref());
        if let Some(place) = place.filter(|_| shortest > longest) {
            let message = format!("the shortest time constant, {shortest}, is above the longest, {longest}");
            let help = "expected time_constant_min to be at most time_constant_max";
            self.findings
                .refuse(Rule::LimitsCrossed, place.at.clone(), message, help);
        }
        Outsiders {
            read: raw
                .reads
                .as_ref()
                .map_or(Reads::All, |reads| Reads::These(values(reads))),
            tap: values(&raw.taps),
            users: values(&raw.users),
            groups: values(&raw.groups),
            layers_max: whole(&raw.layers_max, 16) as usize,
            level_max: whole(&raw.level_max, 255) as u8,
            time_constant_min: shortest,
            time_constant_max: longest,
            messages_max: whole(&raw.messages_max, 1_000) as u32,
        }
    }

    /// A port opened to taps: an input may be suppressed, an output inhibited.
    fn open_tap(&mut self, name: &Placed<PortName>, reflexes: &[Placed<PortName>]) {
        let known = self.modules.get(&name.value.module).and_then(|k| k.declaration);
        if known.is_some() && name.value.module == BODY {
            let message = format!("{} belongs to the body", name.value);
            let help = "expected a port of a module: the body listens to the creature's own layers only";
            self.findings
                .refuse(Rule::BodyClosed, name.at.clone(), message, help);
            return;
        }
        let output = known.is_some_and(|d| d.output(&name.value.port).is_some());
        let input = known.is_some_and(|d| d.input(&name.value.port).is_some());
        if (output || input) && self.feeds_reflex(&name.value, reflexes) {
            self.halt_channel(name);
        } else if !output {
            // Complains if it is no input either.
            let _ = self.port(name, false);
        }
    }

    /// Refuses a list that names something twice.
    fn each_once<T: Eq + Hash + std::fmt::Display>(&mut self, what: &str, given: &[Placed<T>]) {
        let mut seen: HashMap<&T, Range<usize>> = HashMap::new();
        for item in given {
            if let Some(first) = seen.insert(&item.value, item.at.clone()) {
                let message = format!("the {what} {} is named twice", item.value);
                let also = (first, "first here".into());
                let help = "remove one of the two";
                self.findings
                    .refuse_both(Rule::DuplicateEntry, item.at.clone(), message, help, also);
            }
        }
    }
}

fn values<T: Clone>(placed: &[Placed<T>]) -> Vec<T> {
    placed.iter().map(|p| p.value.clone()).collect()
}
