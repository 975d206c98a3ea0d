//! The checker: a file is checked whole before anything of it runs.
//!
//! Must never let a creature through in which a name does not resolve, a type does not match, an input has
//! two writers without a tap, or a lower level could come to depend on a higher one.

use std::collections::HashMap;
use std::ops::Range;

use super::catalog::{Catalog, Declaration, Port, Setting, Takes};
use super::creature::{
    BODY, Body, Creature, Executor, Halt, How, Layer, Module, Outsiders, Policy, PortName, Tap, Wake, Wire,
};
use super::diagnostic::{Findings, Rejected, Source, one_of};
use super::directory::Directory;
use super::document::{self as doc, Keys, Placed};
use super::read::{self, Parts, RawLayer, RawTap};
use crate::clock::Span;
use crate::wire::TAPS_MAX;

/// Checks a creature file.
///
/// # Errors
/// Every error of the file, each with line, column and what was expected.
pub fn creature(source: &Source, catalog: &dyn Catalog) -> Result<Creature, Rejected> {
    check(source, catalog, None)
}

/// Checks the manifest of a layer that wants to join the creature of `host`.
///
/// # Errors
/// Every error of the file, each with line, column and what was expected.
pub fn manifest(source: &Source, catalog: &dyn Catalog, host: &Directory) -> Result<Creature, Rejected> {
    check(source, catalog, Some(host))
}

fn check(source: &Source, catalog: &dyn Catalog, host: Option<&Directory>) -> Result<Creature, Rejected> {
    let mut findings = Findings::default();
    let Some(root) = doc::parse(source, &mut findings) else {
        return findings.into_result(source, None);
    };
    if !findings.is_clean() {
        return findings.into_result(source, None);
    }
    let parts = read::read(&root, &mut findings);
    let whole = findings.is_clean();
    let mut checker = Checker {
        findings,
        catalog,
        host,
        modules: HashMap::new(),
        writers: HashMap::new(),
        tapped: HashMap::new(),
        whole,
    };
    let creature = checker.creature(parts);
    checker.findings.into_result(source, creature)
}

/// A module by name: its declaration and where it stands.
#[derive(Clone, Copy)]
struct Known {
    declaration: &'static Declaration,
    level: u8,
}

struct Checker<'c> {
    findings: Findings,
    catalog: &'c dyn Catalog,
    host: Option<&'c Directory>,
    modules: HashMap<String, Known>,
    /// Which output feeds each input.
    writers: HashMap<PortName, PortName>,
    /// How many taps stand on each port.
    tapped: HashMap<(bool, PortName), usize>,
    /// Whether every part could be read: only then is a missing one an error of its own.
    whole: bool,
}

/// A port as it was found: what it is and the level it belongs to.
struct Found {
    kind: crate::message::Kind,
    unit: String,
    level: Option<u8>,
}

impl Found {
    fn of(port: &Port, level: Option<u8>) -> Found {
        Found {
            kind: port.kind,
            unit: port.unit.into(),
            level,
        }
    }
}

impl Checker<'_> {
    fn creature(&mut self, parts: Parts<'_, '_>) -> Option<Creature> {
        if parts.name.is_none() && self.whole {
            self.findings.error(
                0..0,
                "the creature has no name",
                "add creature = \"...\" at the top",
            );
        }
        if parts.layers.is_empty() && self.whole {
            self.findings.error(
                0..0,
                "there is no layer",
                "add a [[layer]] with name, level and period",
            );
        }
        let body = self.body(parts.body);
        self.layer_names(&parts.layers);
        let mut layers: Vec<(Layer, RawLinks)> = Vec::new();
        for raw in parts.layers {
            layers.push(self.modules(raw));
        }
        for (layer, links) in &mut layers {
            self.wires(layer, links);
        }
        for (layer, links) in &mut layers {
            self.taps(layer, links, &parts.reflexes, &parts.open_taps);
        }
        let reflexes = self.reflexes(&parts.reflexes);
        let tap = self.open_taps(&parts.open_taps);
        self.reached(&layers, &tap);
        let mut layers: Vec<Layer> = layers.into_iter().map(|(layer, _)| layer).collect();
        layers.sort_by_key(|l| l.level);
        Some(Creature {
            name: parts.name?.value,
            seed: parts.seed,
            body,
            layers,
            halt: Halt {
                reflexes,
                hold: parts.hold.unwrap_or(Span::millis(500)),
                stale: parts.stale.unwrap_or(Span::millis(200)),
            },
            executor: Executor {
                policy: Policy::Fifo,
                best_effort: true,
                spin_share_max: 0.1,
            },
            outsiders: Outsiders {
                tap,
                layers_max: parts.layers_max.unwrap_or(16) as usize,
                level_max: parts.level_max.unwrap_or(255) as u8,
                time_constant_max: parts.time_constant_max.unwrap_or(Span::secs(60)),
            },
        })
    }

    fn body(&mut self, raw: Option<read::RawBody<'_, '_>>) -> Option<Body> {
        let raw = raw?;
        if self.host.is_some() {
            self.findings.error(
                raw.kind.at.clone(),
                "a layer that joins a creature brings no body",
                "remove [body]",
            );
            return None;
        }
        let declaration = self.kind(&raw.kind, "kind of body", &self.catalog.bodies())?;
        let settings = self.settings(raw.settings, declaration);
        self.modules.insert(
            BODY.into(),
            Known {
                declaration,
                level: 0,
            },
        );
        Some(Body {
            declaration,
            period: raw.period,
            settings,
        })
    }

    fn kind(
        &mut self,
        given: &Placed<String>,
        what: &str,
        known: &[&'static Declaration],
    ) -> Option<&'static Declaration> {
        let found = known.iter().find(|d| d.name == given.value).copied();
        if found.is_none() {
            let help = one_of(what, &given.value, known.iter().map(|d| d.name));
            self.findings.error(
                given.at.clone(),
                format!("unknown {what} {:?}", given.value),
                help,
            );
        }
        found
    }

    fn settings(&mut self, mut keys: Keys<'_, '_>, declaration: &'static Declaration) -> Vec<Setting> {
        let f = &mut self.findings;
        let mut settings = Vec::new();
        for parameter in declaration.parameters {
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
                Takes::Numbers { .. } => {
                    let items = doc::array(v, "a list of numbers", f);
                    let numbers = items.iter().filter_map(|n| doc::number(n, f64::MIN, f64::MAX, f));
                    Some(Setting::Numbers(numbers.collect()))
                }
            });
            settings.push(read.or(parameter.takes.default()).unwrap_or(Setting::Bit(false)));
        }
        keys.finish(f);
        settings
    }

    fn layer_names(&mut self, layers: &[RawLayer<'_, '_>]) {
        let mut seen: HashMap<&str, ()> = HashMap::new();
        for layer in layers {
            let name = layer.name.value.as_str();
            let taken = self.host.is_some_and(|h| h.layers.iter().any(|l| l == name));
            if taken || seen.insert(name, ()).is_some() {
                let message = format!("there are two layers called {name:?}");
                self.findings.error(
                    layer.name.at.clone(),
                    message,
                    "expected a name of its own for each layer",
                );
            }
            if layer.phase.value >= layer.period {
                let help = format!("expected less than the period, {}", layer.period);
                self.findings.error(
                    layer.phase.at.clone(),
                    "the phase is not shorter than the period",
                    help,
                );
            }
        }
    }

    fn modules(&mut self, raw: RawLayer<'_, '_>) -> (Layer, RawLinks) {
        let mut modules = Vec::new();
        let mut places = Vec::new();
        for module in raw.modules {
            let name = module.name.value.clone();
            let Some(declaration) = self.kind(&module.kind, "kind of module", &self.catalog.modules()) else {
                continue;
            };
            let settings = self.settings(module.settings, declaration);
            let taken = self.host.is_some_and(|h| h.has_module(&name));
            let known = Known {
                declaration,
                level: raw.level,
            };
            if name == BODY || taken || self.modules.insert(name.clone(), known).is_some() {
                let message = format!("there are two modules called {name:?}");
                self.findings.error(
                    module.name.at.clone(),
                    message,
                    "expected a name of its own in the creature",
                );
                continue;
            }
            places.push(module.name.at);
            modules.push(Module {
                name,
                declaration,
                settings,
            });
        }
        let layer = Layer {
            name: raw.name.value,
            level: raw.level,
            period: raw.period,
            phase: raw.phase.value,
            priority: raw.priority,
            cpu: raw.cpu,
            overrun: raw.overrun,
            vital: raw.vital,
            group: None,
            wake: Wake::Sleep,
            modules,
            wires: Vec::new(),
            taps: Vec::new(),
        };
        (
            layer,
            RawLinks {
                wires: raw.wires,
                taps: raw.taps,
                places,
            },
        )
    }

    /// The output (or input) port called `name`, in this file or at the host.
    fn port(&mut self, name: &Placed<PortName>, output: bool) -> Option<Found> {
        let PortName { module, port } = &name.value;
        // Sensors are outputs of the body, commands its inputs: the same words as for modules.
        if let Some(known) = self.modules.get(module) {
            let declared = if output {
                known.declaration.output(port)
            } else {
                known.declaration.input(port)
            };
            let level = (module != BODY).then_some(known.level);
            if let Some((_, found)) = declared {
                return Some(Found::of(found, level));
            }
            let list = if output {
                known.declaration.outputs
            } else {
                known.declaration.inputs
            };
            let what = if output { "output" } else { "input" };
            let help = one_of(what, port, list.iter().map(|p| p.name));
            let message = format!("{module:?} has no {what} {port:?}");
            self.findings.error(name.at.clone(), message, help);
            return None;
        }
        if let Some(host) = self.host {
            let ports = if output { &host.outputs } else { &host.inputs };
            if let Some(found) = ports.iter().find(|p| p.name == name.value.to_string()) {
                return Some(Found {
                    kind: found.kind,
                    unit: found.unit.clone(),
                    level: found.level,
                });
            }
        }
        // Where a part could not be read, its name is missing for that reason.
        if self.whole {
            let mut names: Vec<String> = self.modules.keys().cloned().collect();
            names.extend(self.host.iter().flat_map(|h| h.module_names()));
            let help = one_of("module", module, names.iter().map(String::as_str));
            self.findings
                .error(name.at.clone(), format!("there is no module {module:?}"), help);
        }
        None
    }

    fn wires(&mut self, layer: &mut Layer, links: &RawLinks) {
        for (from, to) in &links.wires {
            let (Some(source), Some(sink)) = (self.port(from, true), self.port(to, false)) else {
                continue;
            };
            self.same_type(from, &source, to, &sink);
            if source.level.is_some_and(|l| l > layer.level) {
                let message = format!(
                    "{} belongs to level {}, above this layer",
                    from.value,
                    source.level.unwrap_or(0)
                );
                let help = "lower layers never rely on higher ones: expected a wire of this level or below";
                self.findings.error(from.at.clone(), message, help);
            }
            let own = layer.modules.iter().any(|m| m.name == to.value.module) || to.value.module == BODY;
            if !own {
                let message = format!("{} is not an input of this layer", to.value);
                let help =
                    "expected a module of this layer, or \"body\"; use suppress to reach into a lower layer";
                self.findings.error(to.at.clone(), message, help);
                continue;
            }
            if let Some(other) = self.writers.insert(to.value.clone(), from.value.clone()) {
                let message = format!("{} is written by {other} already", to.value);
                let help = "expected one writer for each input; a second one joins as a tap (suppress)";
                self.findings.error(to.at.clone(), message, help);
            }
            layer.wires.push(Wire {
                from: from.value.clone(),
                to: to.value.clone(),
            });
        }
    }

    fn same_type(&mut self, from: &Placed<PortName>, source: &Found, to: &Placed<PortName>, sink: &Found) {
        let kinds = source.kind == sink.kind;
        let units = source.unit.is_empty() || sink.unit.is_empty() || source.unit == sink.unit;
        if kinds && units {
            return;
        }
        let spell = |f: &Found| {
            if f.unit.is_empty() {
                f.kind.to_string()
            } else {
                format!("{} in {}", f.kind, f.unit)
            }
        };
        let message = format!(
            "{} carries {}, {} takes {}",
            from.value,
            spell(source),
            to.value,
            spell(sink)
        );
        self.findings.error(
            to.at.clone(),
            message,
            format!("expected an input that takes {}", spell(source)),
        );
    }

    fn taps(
        &mut self,
        layer: &mut Layer,
        links: &RawLinks,
        reflexes: &[Placed<PortName>],
        open: &[Placed<PortName>],
    ) {
        for tap in &links.taps {
            let Some((source, target)) = self.tap_ends(layer, tap) else {
                continue;
            };
            if tap.how == How::Suppress {
                self.same_type(&tap.from, &source, &tap.to, &target);
            }
            let below = target.level.is_none_or(|l| l < layer.level);
            if !below {
                let message = format!(
                    "{} is of level {}, not below this layer",
                    tap.to.value,
                    target.level.unwrap_or(0)
                );
                let help = format!(
                    "taps point downward: expected a port of a level below {}",
                    layer.level
                );
                self.findings.error(tap.to.at.clone(), message, help);
            }
            if tap.how == How::Inhibit && tap.to.value.module == BODY {
                let help = "sensors cannot be blocked for everybody; expected an output of a module";
                self.findings
                    .error(tap.to.at.clone(), format!("{} is a sensor", tap.to.value), help);
            }
            let halt = reflexes.iter().any(|r| r.value == tap.to.value)
                || self
                    .host
                    .is_some_and(|h| h.reflexes.contains(&tap.to.value.to_string()));
            if tap.how == How::Inhibit && halt {
                let message = format!("{} is part of the halt channel", tap.to.value);
                self.findings.error(
                    tap.to.at.clone(),
                    message,
                    "nothing taps the halt channel: remove this tap",
                );
            }
            if let Some(host) = self.host {
                self.allowed(tap, host);
            }
            let count = self
                .tapped
                .entry((tap.how == How::Suppress, tap.to.value.clone()))
                .or_default();
            *count += 1;
            if *count > TAPS_MAX {
                let message = format!("more than {TAPS_MAX} taps on {}", tap.to.value);
                self.findings
                    .error(tap.to.at.clone(), message, format!("expected at most {TAPS_MAX}"));
            }
            let _ = open;
            layer.taps.push(Tap {
                how: tap.how,
                from: tap.from.value.clone(),
                to: tap.to.value.clone(),
                time_constant: tap.time_constant,
            });
        }
    }

    fn tap_ends(&mut self, layer: &Layer, tap: &RawTap) -> Option<(Found, Found)> {
        let source = self.port(&tap.from, true);
        let target = self.port(&tap.to, tap.how == How::Inhibit);
        let (source, target) = (source?, target?);
        if !layer.modules.iter().any(|m| m.name == tap.from.value.module) {
            let message = format!("{} is not an output of this layer", tap.from.value);
            self.findings.error(
                tap.from.at.clone(),
                message,
                "expected an output of one of this layer's modules",
            );
            return None;
        }
        Some((source, target))
    }

    fn allowed(&mut self, tap: &RawTap, host: &Directory) {
        if !self.modules.contains_key(&tap.to.value.module)
            && !host.open_taps.contains(&tap.to.value.to_string())
        {
            let message = format!("the creature does not open {} to taps from outside", tap.to.value);
            let help = one_of(
                "open port",
                &tap.to.value.to_string(),
                host.open_taps.iter().map(String::as_str),
            );
            self.findings.error(tap.to.at.clone(), message, help);
        }
        if tap.time_constant > host.time_constant_max {
            let message = format!("the time constant {} is too long", tap.time_constant);
            self.findings.error(
                tap.to.at.clone(),
                message,
                format!("expected at most {}", host.time_constant_max),
            );
        }
    }

    fn reflexes(&mut self, given: &[Placed<PortName>]) -> Vec<PortName> {
        let mut reflexes = Vec::new();
        for name in given {
            let Some(found) = self.port(name, true) else {
                continue;
            };
            if found.kind != crate::message::Kind::Pulse {
                let message = format!("{} carries {}", name.value, found.kind);
                self.findings.error(
                    name.at.clone(),
                    message,
                    "expected an output that carries a pulse",
                );
            }
            if found.level != Some(0) {
                let message = format!("{} is not of level 0", name.value);
                self.findings
                    .error(name.at.clone(), message, "expected a reflex of level 0");
            }
            reflexes.push(name.value.clone());
        }
        reflexes
    }

    fn open_taps(&mut self, given: &[Placed<PortName>]) -> Vec<PortName> {
        for name in given {
            let both = [true, false].map(|output| self.known_port(&name.value, output));
            if !both.contains(&true) {
                let _ = self.port(name, false);
            }
        }
        given.iter().map(|n| n.value.clone()).collect()
    }

    fn known_port(&self, name: &PortName, output: bool) -> bool {
        let Some(known) = self.modules.get(&name.module) else {
            return false;
        };
        let d = known.declaration;
        if output {
            d.output(&name.port).is_some()
        } else {
            d.input(&name.port).is_some()
        }
    }

    /// A module none of whose inputs anything can reach will never do anything.
    fn reached(&mut self, layers: &[(Layer, RawLinks)], open: &[PortName]) {
        let tapped: Vec<&PortName> = layers
            .iter()
            .flat_map(|(l, _)| &l.taps)
            .map(|t| &t.to)
            .chain(open)
            .collect();
        let mut lost: Vec<(Range<usize>, String)> = Vec::new();
        for (layer, links) in layers {
            for (module, at) in layer.modules.iter().zip(&links.places) {
                let wired = self.writers.keys().any(|to| to.module == module.name)
                    || tapped.iter().any(|to| to.module == module.name);
                if !wired && !module.declaration.inputs.is_empty() {
                    lost.push((at.clone(), module.name.clone()));
                }
            }
        }
        for (at, name) in lost {
            if self.whole {
                let message = format!("nothing reaches module {name:?}");
                self.findings
                    .error(at, message, "expected a wire or a tap into one of its inputs");
            }
        }
    }
}

/// Wires and taps of a layer, before their names are resolved, and where its modules stand.
struct RawLinks {
    wires: Vec<(Placed<PortName>, Placed<PortName>)>,
    taps: Vec<RawTap>,
    places: Vec<Range<usize>>,
}
