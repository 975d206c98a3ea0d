//! The directory: what a running creature shows to a layer that wants to join it.
//!
//! Must never say more than a newcomer needs to be checked: ports, levels and what is open.

use serde::{Deserialize, Serialize};

use super::creature::{BODY, Creature, PortName, Reads};
use crate::clock::Span;
use crate::control::Plug;
use crate::message::Kind;

/// A port of the creature.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// `module.port`.
    pub name: String,
    /// The kind of message.
    pub kind: Kind,
    /// Its unit, or empty.
    pub unit: String,
    /// The level of the layer; none for the body.
    pub level: Option<u8>,
    /// For outputs: who shares the wire's page (see `wire::iceoryx::service_of`).
    #[serde(default)]
    pub owner: String,
    /// For outputs: which wire of that page.
    #[serde(default)]
    pub index: usize,
    /// For outputs of an attached layer: the number of its coming; 0 for the daemon's own.
    #[serde(default)]
    pub plug: u32,
}

/// What a running creature shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Directory {
    /// The creature's name.
    pub creature: String,
    /// Names of its layers.
    pub layers: Vec<String>,
    /// Every output port: the wires.
    pub outputs: Vec<Listed>,
    /// Every input port.
    pub inputs: Vec<Listed>,
    /// Ports that may be tapped from outside.
    pub open_taps: Vec<String>,
    /// Outputs that are part of the halt channel.
    pub reflexes: Vec<String>,
    /// Highest level a layer may claim.
    pub level_max: u8,
    /// Longest time constant of a tap, in nanoseconds.
    pub time_constant_max: Span,
    /// Shortest time constant of a tap, in nanoseconds.
    #[serde(default)]
    pub time_constant_min: Span,
    /// Most messages a second of a tap; none for no limit.
    #[serde(default)]
    pub messages_max: Option<u32>,
    /// Outputs whose wires may be read; none for all.
    #[serde(default)]
    pub open_reads: Option<Vec<String>>,
}

impl Directory {
    /// The directory of a checked creature whose wires are all shared by `owner`, in the order of
    /// [`output_ports`].
    pub fn of(creature: &Creature, owner: &str) -> Directory {
        let listed = |(name, port, level): (PortName, &super::Port, Option<u8>)| Listed {
            name: name.to_string(),
            kind: port.kind,
            unit: port.unit.into(),
            level,
            owner: String::new(),
            index: 0,
            plug: 0,
        };
        let mut outputs: Vec<Listed> = output_ports(creature).map(listed).collect();
        for (index, output) in outputs.iter_mut().enumerate() {
            output.owner = owner.into();
            output.index = index;
        }
        Directory {
            creature: creature.name.clone(),
            layers: creature.layers.iter().map(|l| l.name.clone()).collect(),
            outputs,
            inputs: input_ports(creature).map(listed).collect(),
            open_taps: creature.outsiders.tap.iter().map(PortName::to_string).collect(),
            reflexes: creature.halt.reflexes.iter().map(PortName::to_string).collect(),
            level_max: creature.outsiders.level_max,
            time_constant_max: creature.outsiders.time_constant_max,
            time_constant_min: creature.outsiders.time_constant_min,
            messages_max: Some(creature.outsiders.messages_max),
            open_reads: match &creature.outsiders.read {
                Reads::All => None,
                Reads::These(ports) => Some(ports.iter().map(PortName::to_string).collect()),
            },
        }
    }

    /// Adds an attached layer: it came as number `plug`.
    pub fn join(&mut self, number: u32, plug: &Plug) {
        self.layers.push(plug.layer.clone());
        let first = self.outputs.len();
        self.open(
            &plug.outputs,
            &plug.inputs,
            &plug.open_taps,
            plug.open_reads.as_deref(),
        );
        for output in &mut self.outputs[first..] {
            output.plug = number;
        }
    }

    /// Adds the layer of a manifest that was checked against this directory, as though it had attached.
    pub fn join_checked(&mut self, manifest: &Creature) {
        let name = manifest.layers.first().map_or("", |l| &l.name);
        let more = Directory::of(manifest, &format!("{}/{name}", self.creature));
        self.layers.extend(more.layers);
        self.open(
            &more.outputs,
            &more.inputs,
            &more.open_taps,
            more.open_reads.as_deref(),
        );
    }

    fn open(&mut self, outputs: &[Listed], inputs: &[Listed], taps: &[String], reads: Option<&[String]>) {
        // Where only some wires are open, those of the others have to be named as well.
        if reads.is_some() && self.open_reads.is_none() {
            self.open_reads = Some(self.outputs.iter().map(|o| o.name.clone()).collect());
        }
        if let Some(open) = &mut self.open_reads {
            match reads {
                Some(ports) => open.extend_from_slice(ports),
                None => open.extend(outputs.iter().map(|o| o.name.clone())),
            }
        }
        self.open_taps.extend_from_slice(taps);
        self.inputs.extend_from_slice(inputs);
        self.outputs.extend_from_slice(outputs);
    }

    /// Whether a module of that name is there.
    pub fn has_module(&self, name: &str) -> bool {
        self.module_names().any(|m| m == name)
    }

    /// Names of the modules that have ports, with repetitions.
    pub fn module_names(&self) -> impl Iterator<Item = String> {
        let ports = self.outputs.iter().chain(&self.inputs);
        ports.filter_map(|p| p.name.split_once('.').map(|(module, _)| module.to_string()))
    }
}

/// Every output port of a creature, in the order in which wires are numbered: the body's sensors, then
/// modules layer by layer.
pub fn output_ports(c: &Creature) -> impl Iterator<Item = (PortName, &'static super::Port, Option<u8>)> {
    ports(c, |d| d.outputs)
}

/// Every input port of a creature in the same order, without reset lines.
pub fn input_ports(c: &Creature) -> impl Iterator<Item = (PortName, &'static super::Port, Option<u8>)> {
    ports(c, |d| d.inputs)
}

fn ports(
    creature: &Creature,
    of: fn(&super::Declaration) -> &'static [super::Port],
) -> impl Iterator<Item = (PortName, &'static super::Port, Option<u8>)> {
    let body = creature
        .body
        .iter()
        .map(|b| (BODY.to_string(), b.declaration, None));
    let modules = creature.layers.iter().flat_map(|l| {
        l.modules
            .iter()
            .map(|m| (m.name.clone(), m.declaration, Some(l.level)))
    });
    body.chain(modules).flat_map(move |(module, declaration, level)| {
        of(declaration).iter().map(move |port| {
            (
                PortName {
                    module: module.clone(),
                    port: port.name.into(),
                },
                port,
                level,
            )
        })
    })
}
