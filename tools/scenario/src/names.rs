//! What names there are in a scenario: the creature's and those of the layers that may join.
//!
//! Must never answer for a creature that could not be checked: then nothing is known, and nothing is missing.

use std::collections::BTreeMap;
use std::ops::Range;

use ipc::message::Kind;
use ipc::wiring::Creature;
use ipc::wiring::diagnostic::{Findings, one_of};
use ipc::wiring::directory::{input_ports, output_ports};

/// A name that was found: the kind of its messages, and the level it belongs to.
pub(crate) type Port = (Kind, u8);

/// The names of one scenario.
#[derive(Debug, Default)]
pub(crate) struct Names {
    pub(crate) outputs: BTreeMap<String, Port>,
    pub(crate) inputs: BTreeMap<String, Port>,
    pub(crate) modules: BTreeMap<String, u8>,
    pub(crate) layers: BTreeMap<String, u8>,
    /// Taps, as `from > to`.
    pub(crate) taps: BTreeMap<String, u8>,
    /// Manifests: their layer's level and name.
    pub(crate) manifests: BTreeMap<String, (u8, String)>,
    /// Whether everything that could have a name was read.
    pub(crate) whole: bool,
}

impl Names {
    /// Takes up the names of `part`: the creature, or a manifest.
    pub(crate) fn add(&mut self, part: &Creature) {
        for (name, port, level) in output_ports(part) {
            self.outputs
                .insert(name.to_string(), (port.kind, level.unwrap_or(0)));
        }
        for (name, port, level) in input_ports(part) {
            self.inputs
                .insert(name.to_string(), (port.kind, level.unwrap_or(0)));
        }
        for layer in &part.layers {
            self.layers.insert(layer.name.clone(), layer.level);
            for module in &layer.modules {
                self.modules.insert(module.name.clone(), layer.level);
                let reset = format!("{}.reset", module.name);
                self.inputs.insert(reset, (Kind::Pulse, layer.level));
            }
            for tap in &layer.taps {
                self.taps
                    .insert(format!("{} > {}", tap.from, tap.to), layer.level);
            }
        }
    }

    /// What `name` stands for in `known`; an error if it is not there.
    pub(crate) fn find<T: Clone>(
        &self,
        known: &BTreeMap<String, T>,
        what: &str,
        name: &str,
        at: Range<usize>,
        findings: &mut Findings,
    ) -> Option<T> {
        let found = known.get(name).cloned();
        if found.is_none() && self.whole {
            let help = one_of(what, name, known.keys().map(String::as_str));
            findings.error(at, format!("there is no {what} {name:?}"), help);
        }
        found
    }
}
