//! Who may join a creature, and where: what the creature file lets outsiders do.
//!
//! Must never know how a newcomer was heard of: real time and the virtual clock ask the same questions.

use std::collections::HashMap;
use std::sync::Arc;

use afsm::layer::Command;
use ipc::clock::Span;
use ipc::control::{Plug, PlugTap};
use ipc::message::Kind;
use ipc::wire::{Page, Reader, Room, TapEnd, TapGauge};
use ipc::wiring::creature::{Creature, How, Outsiders};
use ipc::wiring::directory::Directory;
use ipc::wiring::policy::{self, Claim, ClaimedTap};

/// Where a port of the creature is found: which layer, and which register or outlet of it.
pub type Place = (usize, usize);

/// Longest name of a port or an owner: two names of 48 characters and what joins them.
const PORT_NAME_MAX: usize = 160;

/// Most modules of an attached layer: they are only drawn.
const MODULES_MAX: usize = 512;

/// Most taps of an attached layer: fewer than a layer below takes up between two beats.
const PLUG_TAPS_MAX: usize = 64;

type Places = HashMap<String, Place>;

/// What a creature lets outsiders do, and where its ports are.
#[derive(Clone, Debug)]
pub struct Policy {
    creature: Creature,
    directory: Directory,
    inputs: Places,
    outputs: Places,
}

/// A tap about to be joined.
#[derive(Debug)]
pub struct Joining {
    /// Which layer of the creature takes it up.
    pub station: usize,
    /// What that layer is told.
    pub command: Command,
    /// Where what happens at it is counted.
    pub gauge: Arc<TapGauge>,
    /// Its messages.
    pub reader: Reader,
}

impl Policy {
    /// The policy of `creature`, which shows `directory`.
    pub fn new(creature: Creature, directory: Directory) -> Policy {
        let (mut inputs, mut outputs) = (Places::new(), Places::new());
        for (station, layer) in creature.layers.iter().enumerate() {
            let (mut input, mut output) = (0, 0);
            for module in &layer.modules {
                for port in module.declaration.inputs {
                    inputs.insert(format!("{}.{}", module.name, port.name), (station, input));
                    input += 1;
                }
                inputs.insert(format!("{}.reset", module.name), (station, input));
                input += 1;
                for port in module.declaration.outputs {
                    outputs.insert(format!("{}.{}", module.name, port.name), (station, output));
                    output += 1;
                }
            }
        }
        Policy {
            creature,
            directory,
            inputs,
            outputs,
        }
    }

    /// What the creature file lets outsiders do.
    pub fn outsiders(&self) -> &Outsiders {
        &self.creature.outsiders
    }

    /// Where the input port `name` of a module of the creature is found.
    pub fn input(&self, name: &str) -> Option<Place> {
        self.inputs.get(name).copied()
    }

    /// Where the output port `name` of a module of the creature is found.
    pub fn output(&self, name: &str) -> Option<Place> {
        self.outputs.get(name).copied()
    }

    /// What the creature shows to newcomers, those `attached` included.
    pub fn directory_with<'p>(&self, attached: impl IntoIterator<Item = &'p Plug>) -> Directory {
        let mut directory = self.directory.clone();
        for plug in attached {
            directory.layers.push(plug.layer.clone());
            directory.outputs.extend(plug.outputs.iter().cloned());
        }
        directory
    }

    /// The tap of `plug`, which was let in as number `number` with its wires in `page`; counted at `gauge`.
    ///
    /// # Panics
    /// When there were reasons against it.
    pub fn join(
        &self,
        number: u32,
        plug: &Plug,
        tap: &PlugTap,
        page: &Arc<Page>,
        gauge: Arc<TapGauge>,
    ) -> Joining {
        let mut outputs = plug.outputs.iter();
        let index = outputs.position(|o| o.name == tap.from).expect("checked");
        let reader = page.reader(index, plug.outputs[index].kind).expect("checked");
        let end = TapEnd {
            reader: reader.clone(),
            time_constant: tap.time_constant,
            level: plug.level,
            plug: number,
            gauge: gauge.clone(),
            room: Room::full(),
        };
        let (places, command): (_, fn(usize, TapEnd) -> Command) = match tap.how {
            How::Suppress => (&self.inputs, Command::Suppress),
            How::Inhibit => (&self.outputs, Command::Inhibit),
        };
        let (station, port) = places[&tap.to];
        Joining {
            station,
            command: command(port, end),
            gauge,
            reader,
        }
    }

    /// Every reason why `plug` may not join those `attached`.
    pub fn reasons_against<'p>(
        &self,
        plug: &Plug,
        attached: impl IntoIterator<Item = &'p Plug>,
    ) -> Vec<String> {
        let mut reasons = Vec::new();
        let outsiders = &self.creature.outsiders;
        let mut against = |wrong: bool, reason: String| {
            if wrong {
                reasons.push(reason);
            }
        };
        let attached: Vec<&Plug> = attached.into_iter().collect();
        against(
            attached.len() >= outsiders.layers_max,
            format!("{} layers are attached, the most allowed", attached.len()),
        );
        against(
            plug.outputs.len() > ipc::wire::WIRES_MAX,
            "too many outputs".into(),
        );
        against(!crate::is_name(&plug.layer), "the layer's name is not one".into());
        against(plug.period == Span::ZERO, "a layer needs a period".into());
        let longest = plug.outputs.iter().map(|o| o.name.len()).max().unwrap_or(0);
        against(
            longest > PORT_NAME_MAX || plug.owner.len() > PORT_NAME_MAX,
            "its names are too long".into(),
        );
        against(
            plug.modules.len() > MODULES_MAX || plug.taps.len() > PLUG_TAPS_MAX,
            "it has too many modules or taps".into(),
        );
        for tap in &plug.taps {
            self.reasons_against_tap(plug, tap, &mut against);
        }
        let breaches = policy::breaches(&self.directory_with(attached), &claim(plug));
        reasons.extend(breaches.iter().map(policy::Breach::to_string));
        reasons
    }

    fn reasons_against_tap(&self, plug: &Plug, tap: &PlugTap, against: &mut impl FnMut(bool, String)) {
        let to = &tap.to;
        let ports = if tap.how == How::Suppress {
            &self.directory.inputs
        } else {
            &self.directory.outputs
        };
        let target = ports.iter().find(|p| p.name == *to);
        let source = plug.outputs.iter().find(|o| o.name == tap.from);
        let places = if tap.how == How::Suppress {
            &self.inputs
        } else {
            &self.outputs
        };
        against(
            target.is_none() || !places.contains_key(to),
            format!("there is no such port {to} to tap"),
        );
        against(
            source.is_none(),
            format!("{} is not among the layer's outputs", tap.from),
        );
        against(
            tap.time_constant == Span::ZERO,
            "a tap needs a time constant".into(),
        );
        let Some(target) = target else { return };
        against(
            target.level.is_none_or(|l| l >= plug.level),
            format!("{to} is not of a level below {}", plug.level),
        );
        let kinds: (Option<Kind>, Kind) = (source.map(|s| s.kind), target.kind);
        let differ = tap.how == How::Suppress && kinds.0.is_some_and(|kind| kind != kinds.1);
        against(
            differ,
            format!("{} does not carry what {to} takes, {}", tap.from, kinds.1),
        );
    }
}

/// What a layer asks for, as the creature's policy judges it.
fn claim(plug: &Plug) -> Claim<'_> {
    let own = |name: &str| plug.outputs.iter().any(|o| o.name == name);
    let reads = plug.wires.iter().map(|(from, _)| from.as_str());
    let tap = |tap: &PlugTap| ClaimedTap {
        how: tap.how,
        to: tap.to.clone(),
        time_constant: tap.time_constant,
    };
    Claim {
        layer: &plug.layer,
        level: plug.level,
        reads: reads.filter(|from| !own(from)).collect(),
        taps: plug.taps.iter().map(tap).collect(),
    }
}
