//! The manifest: what a recording says of the creature before anything happens.
//!
//! Must never hold what changes while it runs, but for the layers that were attached when the recording began.

use std::time::SystemTime;

use ipc::clock::{self, Span, Time};
use ipc::control::{Plug, PlugModule};
use ipc::message::Kind;
use ipc::wiring::creature::{BODY, Creature, How, Layer, PortName};
use ipc::wiring::{Declaration, Port, catalog};
use serde::{Deserialize, Serialize};

/// Version of what is in a recording; changes whenever it does.
pub const FORMAT: u32 = 1;

/// The name of the motor unit among the sources.
pub const MOTOR: &str = "motor";

/// What a recording says of the creature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the format, see [`FORMAT`].
    pub format: u32,
    /// Name of the instance.
    pub creature: String,
    /// The program that recorded.
    pub program: String,
    /// Seed of everything random.
    pub seed: u64,
    /// When the daemon began, in nanoseconds of its monotonic clock.
    pub began_ns: u64,
    /// Nanoseconds from the monotonic clock to the time of day: what was added to get log times.
    pub offset_ns: i64,
    /// Name of each cause of a halt, in the order of its bit.
    pub causes: Vec<String>,
    /// The threads that beat: the layers in the order of the file, then the motor unit if there is a body.
    pub sources: Vec<Source>,
    /// Taps of the creature file.
    pub taps: Vec<Tap>,
    /// Wires of the creature file, from output port to input port.
    pub wires: Vec<(String, String)>,
    /// Layers attached when the recording began.
    pub plugs: Vec<Plugged>,
    /// The creature file; an attachment of the recording.
    #[serde(skip)]
    pub file: String,
}

/// A thread that beats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// The layer, or [`MOTOR`].
    pub name: String,
    /// Its level; none for the motor unit.
    pub level: Option<u8>,
    /// Time between its beats.
    pub period: Span,
    /// Where its beats lie within the period.
    pub phase: Span,
    /// Its input ports by slot, each module's reset line last.
    pub inputs: Vec<Slot>,
    /// Its output ports by slot.
    pub outputs: Vec<Slot>,
    /// Its modules; none for the motor unit.
    pub modules: Vec<PlugModule>,
}

/// A port of a source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slot {
    /// `module.port`.
    pub name: String,
    /// The kind of message.
    pub kind: Kind,
    /// Its unit, or empty.
    pub unit: String,
}

/// A tap of the creature file, or of an attached layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tap {
    /// The number that traces know it by.
    pub number: u16,
    /// Which way it acts.
    pub how: How,
    /// Where its messages come from.
    pub from: String,
    /// Where it acts.
    pub to: String,
    /// Level of its layer.
    pub level: u8,
    /// Its layer.
    pub layer: String,
    /// Its time constant.
    pub time_constant: Span,
}

/// A layer process that is attached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plugged {
    /// Its number.
    pub number: u32,
    /// As it asked for.
    pub plug: Plug,
    /// The numbers of its taps, in its own order.
    pub taps: Vec<u16>,
}

impl Plugged {
    /// Its taps with their numbers.
    pub fn taps(&self) -> impl Iterator<Item = Tap> {
        let plug = &self.plug;
        plug.taps.iter().zip(&self.taps).map(move |(tap, &number)| Tap {
            number,
            how: tap.how,
            from: tap.from.clone(),
            to: tap.to.clone(),
            level: plug.level,
            layer: plug.layer.clone(),
            time_constant: tap.time_constant,
        })
    }
}

impl Manifest {
    /// Of `creature`, running as `name` since `began`, checked from the text `file`.
    pub fn of(creature: &Creature, name: &str, file: &str, began: Time, causes: Vec<String>) -> Manifest {
        let mut sources: Vec<Source> = creature.layers.iter().map(layer).collect();
        if let Some(body) = &creature.body {
            sources.push(Source {
                name: MOTOR.into(),
                level: None,
                period: body.period,
                phase: Span::ZERO,
                inputs: slots(BODY, body.declaration.inputs.iter()),
                outputs: slots(BODY, body.declaration.outputs.iter()),
                modules: Vec::new(),
            });
        }
        let taps = creature
            .layers
            .iter()
            .flat_map(|l| l.taps.iter().map(move |t| (l, t)));
        let taps = taps.zip(1..).map(|((layer, tap), number)| Tap {
            number,
            how: tap.how,
            from: tap.from.to_string(),
            to: tap.to.to_string(),
            level: layer.level,
            layer: layer.name.clone(),
            time_constant: tap.time_constant,
        });
        let wires = creature.layers.iter().flat_map(|l| &l.wires);
        Manifest {
            format: FORMAT,
            creature: name.into(),
            program: concat!("subsumed ", env!("CARGO_PKG_VERSION")).into(),
            seed: creature.seed,
            began_ns: began.0,
            offset_ns: offset(),
            causes,
            sources,
            taps: taps.collect(),
            wires: wires.map(|w| (w.from.to_string(), w.to.to_string())).collect(),
            plugs: Vec::new(),
            file: file.into(),
        }
    }

    /// Seconds since the daemon began.
    pub fn seconds(&self, time: Time) -> f64 {
        (time.0 as i64 - self.began_ns as i64) as f64 * 1e-9
    }

    /// The source called `name`.
    pub fn source(&self, name: &str) -> Option<usize> {
        self.sources.iter().position(|s| s.name == name)
    }

    /// The source and slot that write a wire.
    pub fn writer_of(&self, wire: &str) -> Option<(usize, usize)> {
        let slot = |s: &Source| s.outputs.iter().position(|o| o.name == wire);
        self.sources
            .iter()
            .enumerate()
            .find_map(|(i, s)| Some((i, slot(s)?)))
    }

    /// The source and slot of an input port.
    pub fn register_of(&self, port: &str) -> Option<(usize, usize)> {
        let slot = |s: &Source| s.inputs.iter().position(|i| i.name == port);
        self.sources
            .iter()
            .enumerate()
            .find_map(|(i, s)| Some((i, slot(s)?)))
    }

    /// The wire into an input port.
    pub fn wire_into(&self, port: &str) -> Option<&str> {
        self.wires
            .iter()
            .find(|(_, to)| to == port)
            .map(|(from, _)| from.as_str())
    }

    /// The causes in a set of them, by name.
    pub fn cause_names(&self, bits: u64) -> Vec<&str> {
        let named = self.causes.iter().enumerate();
        named
            .filter(|(bit, _)| bits >> bit & 1 == 1)
            .map(|(_, name)| name.as_str())
            .collect()
    }
}

fn layer(layer: &Layer) -> Source {
    let mut source = Source {
        name: layer.name.clone(),
        level: Some(layer.level),
        period: layer.period,
        phase: layer.phase,
        inputs: Vec::new(),
        outputs: Vec::new(),
        modules: Vec::new(),
    };
    for module in &layer.modules {
        let declaration: &Declaration = module.declaration;
        let inputs = declaration.inputs.iter().chain([&catalog::RESET]);
        source.inputs.extend(slots(&module.name, inputs));
        source
            .outputs
            .extend(slots(&module.name, declaration.outputs.iter()));
        let names = |ports: &[Port]| ports.iter().map(|p| p.name.to_string()).collect();
        source.modules.push(PlugModule {
            name: module.name.clone(),
            kind: declaration.name.into(),
            inputs: names(declaration.inputs),
            outputs: names(declaration.outputs),
        });
    }
    source
}

fn slots<'p>(module: &str, ports: impl Iterator<Item = &'p Port>) -> Vec<Slot> {
    let name = |port: &str| PortName {
        module: module.into(),
        port: port.into(),
    };
    ports
        .map(|port| Slot {
            name: name(port.name).to_string(),
            kind: port.kind,
            unit: port.unit.into(),
        })
        .collect()
}

/// Nanoseconds from the monotonic clock to the time of day, now.
fn offset() -> i64 {
    let day = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .unwrap_or_default();
    day.as_nanos() as i64 - clock::monotonic().0 as i64
}
