//! Ports: what a name such as `turn.heading` stands for, and whether two ports speak of the same thing.
//!
//! Must never complain of a port whose module could not be read: that was complained of already.

use super::Checker;
use crate::message::Kind;
use crate::wiring::catalog::{Port, RESET};
use crate::wiring::creature::{BODY, PortName};
use crate::wiring::directory::Listed;
use crate::wiring::document::Placed;
use crate::wiring::rule::Rule;

/// A port as it was found: what it is and where it belongs.
pub(super) struct Found {
    pub(super) kind: Kind,
    pub(super) unit: String,
    /// The level of its layer; none for the body.
    pub(super) level: Option<u8>,
    /// Index of its layer in the file; none for the body and for ports of the host.
    pub(super) layer: Option<usize>,
}

impl Found {
    fn of(port: &Port, level: Option<u8>, layer: Option<usize>) -> Found {
        Found {
            kind: port.kind,
            unit: port.unit.into(),
            level,
            layer,
        }
    }

    fn listed(port: &Listed) -> Found {
        Found {
            kind: port.kind,
            unit: port.unit.clone(),
            level: port.level,
            layer: None,
        }
    }

    fn spell(&self) -> String {
        if self.unit.is_empty() {
            self.kind.to_string()
        } else {
            format!("{} in {}", self.kind, self.unit)
        }
    }
}

impl Checker<'_> {
    /// The output (or input) port called `name`, in this file or at the host.
    pub(super) fn port(&mut self, name: &Placed<PortName>, output: bool) -> Option<Found> {
        let PortName { module, port } = &name.value;
        // Sensors are outputs of the body, commands its inputs: the same words as for modules.
        let (what, other) = if output {
            ("output", "input")
        } else {
            ("input", "output")
        };
        let Some(known) = self.modules.get(module) else {
            return self.port_of_host(name, output);
        };
        let declaration = known.declaration?;
        let body = module == BODY;
        let (level, layer) = ((!body).then_some(known.level), (!body).then_some(known.layer));
        let find = |output: bool| {
            if output {
                declaration.output(port).map(|(_, p)| p)
            } else {
                declaration
                    .input(port)
                    .map(|(_, p)| p)
                    .filter(|_| !body || port != RESET.name)
            }
        };
        if let Some(found) = find(output) {
            return Some(Found::of(found, level, layer));
        }
        let list = if output {
            declaration.outputs
        } else {
            declaration.inputs
        };
        let reset = (!output && !body).then_some(RESET.name);
        let names = list.iter().map(|p| p.name).chain(reset);
        let mut help = self.findings.one_of(what, port, names);
        if find(!output).is_some() {
            help = format!("{:?} is an {other} of {module:?}; {help}", port);
        }
        let message = format!("{module:?} has no {what} {port:?}");
        self.findings
            .refuse(Rule::UnknownPort, name.at.clone(), message, help);
        None
    }

    fn port_of_host(&mut self, name: &Placed<PortName>, output: bool) -> Option<Found> {
        let PortName { module, port } = &name.value;
        let what = if output { "output" } else { "input" };
        if let Some(host) = self.host {
            let ports = if output { &host.outputs } else { &host.inputs };
            let whole = name.value.to_string();
            if let Some(found) = ports.iter().find(|p| p.name == whole) {
                return Some(Found::listed(found));
            }
            if host.has_module(module) {
                let of_module = ports
                    .iter()
                    .filter_map(|p| p.name.split_once('.'))
                    .filter(|(m, _)| m == module)
                    .map(|(_, p)| p);
                let help = self.findings.one_of(what, port, of_module);
                let message = format!(
                    "{module:?} of the creature {:?} has no {what} {port:?}",
                    host.creature
                );
                self.findings
                    .refuse(Rule::UnknownPort, name.at.clone(), message, help);
                return None;
            }
        }
        // Where a line could not be read, the module may stand in that line.
        if self.findings.has_lost_lines() {
            return None;
        }
        if module == BODY && self.host.is_none() {
            let help = "add a [body] with its kind, or leave this wire out";
            self.findings.refuse(
                Rule::UnknownModule,
                name.at.clone(),
                "the creature has no body",
                help,
            );
            return None;
        }
        let own = self.modules.keys().map(String::as_str);
        let outer: Vec<String> = self.host.iter().flat_map(|h| h.module_names()).collect();
        let help = self
            .findings
            .one_of("module", module, own.chain(outer.iter().map(String::as_str)));
        let message = format!("there is no module {module:?}");
        self.findings
            .refuse(Rule::UnknownModule, name.at.clone(), message, help);
        None
    }

    /// Refuses two ends that do not speak of the same thing.
    pub(super) fn same_type(
        &mut self,
        from: &Placed<PortName>,
        source: &Found,
        to: &Placed<PortName>,
        sink: &Found,
    ) {
        let units = source.unit.is_empty() || sink.unit.is_empty() || source.unit == sink.unit;
        let rule = match (source.kind == sink.kind, units) {
            (true, true) => return,
            (true, false) => Rule::UnitMismatch,
            (false, _) => Rule::TypeMismatch,
        };
        let (carries, takes) = (source.spell(), sink.spell());
        let message = format!("{} carries {carries}, {} takes {takes}", from.value, to.value);
        let fits = |port: &Port| {
            port.kind == source.kind
                && (port.unit.is_empty() || source.unit.is_empty() || port.unit == source.unit)
        };
        let module = &to.value.module;
        let inputs = self
            .modules
            .get(module)
            .and_then(|k| k.declaration)
            .map_or(&[][..], |d| d.inputs);
        let names: Vec<String> = inputs
            .iter()
            .filter(|p| fits(p))
            .map(|p| format!("{:?}", p.name))
            .collect();
        let help = if names.is_empty() {
            format!("expected an input that takes {carries}")
        } else {
            format!(
                "expected an input that takes {carries}; of {module:?} that is {}",
                names.join(", ")
            )
        };
        self.findings.refuse(rule, to.at.clone(), message, help);
    }
}
