//! Who may join a creature, and where: what the creature file lets outsiders do.
//!
//! Must never know how a newcomer was heard of: real time and the virtual clock ask the same questions.

use std::sync::Arc;

use afsm::places::Places;
use ipc::clock::Span;
use ipc::control::{Plug, PlugTap};
use ipc::message::Kind;
use ipc::wire::{Page, Room, TAPS_MAX, TapEnd, TapGauge};
use ipc::wiring::creature::{Creature, How, Outsiders};
use ipc::wiring::directory::{Directory, Listed};
use ipc::wiring::policy::{self, Claim, ClaimedTap};

/// Where a port of the creature is found: which layer, and which register or outlet of it.
pub type Place = (usize, usize);

/// Longest name of a port or an owner: two names of 48 characters and what joins them.
const PORT_NAME_MAX: usize = 160;

/// Most modules of an attached layer: they are only drawn.
const MODULES_MAX: usize = 512;

/// Most taps of an attached layer: fewer than a layer below takes up between two beats.
const PLUG_TAPS_MAX: usize = 64;

/// A layer that is attached: the number of its coming, and what it asked for.
pub type Present<'p> = (u32, &'p Plug);

/// What a creature lets outsiders do, and where its ports are.
#[derive(Clone, Debug)]
pub struct Policy {
    creature: Creature,
    directory: Directory,
    places: Vec<Places>,
}

impl Policy {
    /// The policy of `creature`, which shows `directory`.
    pub fn new(creature: Creature, directory: Directory) -> Policy {
        Policy {
            places: creature.layers.iter().map(Places::of).collect(),
            creature,
            directory,
        }
    }

    /// What the creature file lets outsiders do.
    pub fn outsiders(&self) -> &Outsiders {
        &self.creature.outsiders
    }

    /// Where the input port `name` of a module of the creature is found.
    pub fn input(&self, name: &str) -> Option<Place> {
        self.place(How::Suppress, name)
    }

    /// Where the output port `name` of a module of the creature is found.
    pub fn output(&self, name: &str) -> Option<Place> {
        self.place(How::Inhibit, name)
    }

    /// Where a tap that acts so on the port `name` of a module of the creature is joined.
    pub fn place(&self, how: How, name: &str) -> Option<Place> {
        let mut layers = self.places.iter().enumerate();
        layers.find_map(|(station, places)| Some((station, places.tapped(how, name)?)))
    }

    /// What the creature shows to newcomers, those `attached` included.
    pub fn directory_with<'p>(&self, attached: impl IntoIterator<Item = Present<'p>>) -> Directory {
        let mut directory = self.directory.clone();
        for (number, plug) in attached {
            directory.join(number, plug);
        }
        directory
    }

    /// Every reason why `plug` may not join those `attached`.
    pub fn reasons_against<'p>(
        &self,
        plug: &Plug,
        attached: impl IntoIterator<Item = Present<'p>>,
    ) -> Vec<String> {
        let mut reasons = Vec::new();
        let outsiders = &self.creature.outsiders;
        let mut against = |wrong: bool, reason: String| {
            if wrong {
                reasons.push(reason);
            }
        };
        let attached: Vec<Present<'p>> = attached.into_iter().collect();
        let host = self.directory_with(attached.iter().copied());
        against(
            attached.len() >= outsiders.layers_max,
            format!("{} layers are attached, the most allowed", attached.len()),
        );
        let ports = [&plug.outputs, &plug.inputs];
        against(
            ports.iter().any(|ports| ports.len() > ipc::wire::WIRES_MAX),
            "too many outputs or inputs".into(),
        );
        against(!crate::is_name(&plug.layer), "the layer's name is not one".into());
        against(plug.period == Span::ZERO, "a layer needs a period".into());
        let ports = || plug.outputs.iter().chain(&plug.inputs);
        let longest = ports().map(|o| o.name.len()).max().unwrap_or(0);
        against(
            longest > PORT_NAME_MAX || plug.owner.len() > PORT_NAME_MAX,
            "its names are too long".into(),
        );
        against(
            plug.modules.len() > MODULES_MAX || plug.taps.len() > PLUG_TAPS_MAX,
            "it has too many modules or taps".into(),
        );
        let module = |l: &Listed| {
            l.name
                .split_once('.')
                .map_or("", |(module, _)| module)
                .to_string()
        };
        let taken = ports().map(module).find(|module| host.has_module(module));
        let taken_name = taken.clone().unwrap_or_default();
        against(
            taken.is_some(),
            format!("a module {taken_name:?} is there already"),
        );
        let own = |name: &String, of: &[Listed]| of.iter().any(|l| l.name == *name);
        let opened = plug.open_taps.iter();
        let opened = opened.filter(|name| !own(name, &plug.inputs) && !own(name, &plug.outputs));
        let reads = plug.open_reads.iter().flatten();
        for name in opened.chain(reads.filter(|name| !own(name, &plug.outputs))) {
            against(true, format!("it opens {name}, which is not its own"));
        }
        for (from, _) in &plug.wires {
            let level = host
                .outputs
                .iter()
                .find(|o| o.name == *from)
                .and_then(|o| o.level);
            against(
                level.is_some_and(|level| level > plug.level),
                format!("{from} is of a level above {}", plug.level),
            );
        }
        for tap in &plug.taps {
            self.reasons_against_tap(plug, tap, &host, &mut against);
            let on = |t: &&PlugTap| t.how == tap.how && t.to == tap.to;
            let taps = attached.iter().flat_map(|(_, p)| &p.taps).chain(&plug.taps);
            let filed = self.creature.layers.iter().flat_map(|l| &l.taps);
            let filed = filed.filter(|t| t.how == tap.how && t.to.to_string() == tap.to);
            let taps = taps.filter(on).count() + filed.count();
            against(
                taps > TAPS_MAX,
                format!("{} has as many taps as a port may have, {TAPS_MAX}", tap.to),
            );
        }
        let breaches = policy::breaches(&host, &claim(plug));
        reasons.extend(breaches.iter().map(policy::Breach::to_string));
        reasons
    }

    /// Every reason why a tap of `plug`, which stood before, may not be joined to a port of `owner`, which has come
    /// back.
    pub fn reasons_against_rejoining(&self, plug: &Plug, tap: &PlugTap, owner: Present<'_>) -> Vec<String> {
        let host = self.directory_with([owner]);
        let mut reasons = Vec::new();
        self.reasons_against_tap(plug, tap, &host, &mut |wrong, reason| {
            if wrong {
                reasons.push(reason);
            }
        });
        let claim = Claim {
            reads: Vec::new(),
            taps: vec![claimed(tap)],
            ..claim(plug)
        };
        let breaches = policy::breaches(&host, &claim);
        reasons.extend(breaches.iter().map(policy::Breach::to_string));
        reasons
    }

    fn reasons_against_tap(
        &self,
        plug: &Plug,
        tap: &PlugTap,
        host: &Directory,
        against: &mut impl FnMut(bool, String),
    ) {
        let to = &tap.to;
        let own = match tap.how {
            How::Suppress => &self.directory.inputs,
            How::Inhibit => &self.directory.outputs,
        };
        let target = tapped(tap.how, host, to);
        let source = plug.outputs.iter().find(|o| o.name == tap.from);
        // The body's ports are listed, and are nobody's to tap.
        let closed = own.iter().any(|p| p.name == *to) && self.place(tap.how, to).is_none();
        against(
            target.is_none() || closed,
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

/// The port that a tap acts on.
fn tapped<'h>(how: How, host: &'h Directory, name: &str) -> Option<&'h Listed> {
    let ports = match how {
        How::Suppress => &host.inputs,
        How::Inhibit => &host.outputs,
    };
    ports.iter().find(|p| p.name == *name)
}

/// Whether an attached layer has the port that a tap acts on.
pub fn has_port(plug: &Plug, tap: &PlugTap) -> bool {
    let ports = match tap.how {
        How::Suppress => &plug.inputs,
        How::Inhibit => &plug.outputs,
    };
    ports.iter().any(|p| p.name == tap.to)
}

/// The end of a tap of `plug`, which was let in as number `number` with its wires in `page`; counted at `gauge`.
///
/// # Panics
/// When there were reasons against it.
pub fn tap_end(number: u32, plug: &Plug, tap: &PlugTap, page: &Arc<Page>, gauge: Arc<TapGauge>) -> TapEnd {
    let mut outputs = plug.outputs.iter();
    let index = outputs.position(|o| o.name == tap.from).expect("checked");
    let kind = plug.outputs[index].kind;
    TapEnd {
        reader: page.reader(index, kind).expect("checked"),
        time_constant: tap.time_constant,
        level: plug.level,
        plug: number,
        gauge,
        room: Room::full(kind),
    }
}

/// What a layer asks for, with what it says of its ports put in order: their level is its own, and its wires lie in
/// its page as it lists them.
pub fn settled(mut plug: Plug) -> Plug {
    for input in &mut plug.inputs {
        input.level = Some(plug.level);
    }
    for (index, output) in plug.outputs.iter_mut().enumerate() {
        output.level = Some(plug.level);
        output.owner.clone_from(&plug.owner);
        output.index = index;
    }
    plug
}

/// What a layer asks for, as the creature's policy judges it.
fn claim(plug: &Plug) -> Claim<'_> {
    let own = |name: &str| plug.outputs.iter().any(|o| o.name == name);
    let reads = plug.wires.iter().map(|(from, _)| from.as_str());
    Claim {
        layer: &plug.layer,
        level: plug.level,
        reads: reads.filter(|from| !own(from)).collect(),
        taps: plug.taps.iter().map(claimed).collect(),
    }
}

fn claimed(tap: &PlugTap) -> ClaimedTap {
    ClaimedTap {
        how: tap.how,
        to: tap.to.clone(),
        time_constant: tap.time_constant,
    }
}
