//! A creature as checked: what the executor assembles and pictures are drawn from.
//!
//! Must never be made but by the checker ([`super::check`]): that every name in it resolves, every type
//! matches and every tap points downward is then a fact, not a hope.

use super::catalog::{Declaration, Setting};
use crate::clock::Span;

/// The name under which the body's ports appear on wires.
pub const BODY: &str = "body";

/// SCHED_FIFO priority of the motor unit; layers without a priority of their own get those below it. Above what
/// ordinary programs choose, below the kernel's own threads at 99.
pub const PRIORITY_MAX: u8 = 80;

/// The priority of a layer that names none: the shorter its period among `periods` (sorted, each once), the
/// higher (rate-monotonic).
pub fn rate_monotonic(periods: &[Span], period: Span) -> u8 {
    let rank = periods.partition_point(|p| *p < period);
    let below = u8::try_from(rank).unwrap_or(u8::MAX).saturating_add(1);
    PRIORITY_MAX.saturating_sub(below).max(1)
}

/// A checked creature.
#[derive(Clone, Debug)]
pub struct Creature {
    /// Its name.
    pub name: String,
    /// The seed of everything random in it.
    pub seed: u64,
    /// Its body, if it has one (a manifest of a layer has none).
    pub body: Option<Body>,
    /// Its layers, lowest level first.
    pub layers: Vec<Layer>,
    /// How it halts.
    pub halt: Halt,
    /// What processes outside may do.
    pub outsiders: Outsiders,
    /// How its beats are scheduled.
    pub executor: Executor,
}

/// The body and its motor unit.
#[derive(Clone, Debug)]
pub struct Body {
    /// What kind.
    pub declaration: &'static Declaration,
    /// Beat of the motor unit.
    pub period: Span,
    /// Its parameters, in the declaration's order.
    pub settings: Vec<Setting>,
}

/// A layer: the modules that together give one level of competence.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Its level, counted up from 0.
    pub level: u8,
    /// Time between beats.
    pub period: Span,
    /// When its beats lie within the period.
    pub phase: Span,
    /// SCHED_FIFO priority; rate-monotonic if not given.
    pub priority: Option<u8>,
    /// The processor it is bound to; any if not given.
    pub cpu: Option<usize>,
    /// What happens when a beat runs over its period.
    pub overrun: Overrun,
    /// Whether the body halts when it misses its beats.
    pub vital: bool,
    /// The group whose thread it shares; a thread of its own if none. Layers of one group have equal
    /// period, phase, priority, processor and way of waking.
    pub group: Option<String>,
    /// How its thread waits for the beat.
    pub wake: Wake,
    /// Its modules, in the order of the file.
    pub modules: Vec<Module>,
    /// Wires into its modules and into the body.
    pub wires: Vec<Wire>,
    /// Taps it joins into lower layers, in the order of the file.
    pub taps: Vec<Tap>,
}

/// A module: one augmented finite state machine.
#[derive(Clone, Debug)]
pub struct Module {
    /// Its name, unique in the creature.
    pub name: String,
    /// What kind.
    pub declaration: &'static Declaration,
    /// Its parameters, in the declaration's order.
    pub settings: Vec<Setting>,
}

/// A port of a module (or of the body): `module.port`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PortName {
    /// The module, or [`BODY`].
    pub module: String,
    /// The port.
    pub port: String,
}

impl std::fmt::Display for PortName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}", self.module, self.port)
    }
}

/// A connection from an output port to an input port. The wire itself is named after the output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wire {
    /// The output port.
    pub from: PortName,
    /// The input port.
    pub to: PortName,
}

/// Which way a tap acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum How {
    /// At an input port: replaces.
    Suppress,
    /// At an output port: drops.
    Inhibit,
}

/// A side-tap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tap {
    /// Which way it acts.
    pub how: How,
    /// The output port its messages come from.
    pub from: PortName,
    /// The port it acts on: an input for suppress, an output for inhibit.
    pub to: PortName,
    /// Its time constant τ.
    pub time_constant: Span,
}

/// What happens when a beat runs over its period.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Overrun {
    /// The beats that were missed are left out; the next one comes at its own time.
    Skip,
    /// The beats that were missed are made up for, back to back.
    CatchUp,
    /// The body halts.
    Halt,
}

/// How a thread waits for its beat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wake {
    /// Sleeps until the beat.
    #[default]
    Sleep,
    /// Sleeps until this long before the beat and spins the rest: more even, for a share of a processor.
    Spin(Span),
}

/// How beats are scheduled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Executor {
    /// The scheduler that is asked for.
    pub policy: Policy,
    /// Whether the creature runs on, marked as best effort, where the host grants no real-time scheduling;
    /// if not, the start is refused there.
    pub best_effort: bool,
    /// Largest share of one processor, from 0 to 1, that layers may spend spinning.
    pub spin_share_max: f64,
}

/// A real-time scheduler of the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// SCHED_FIFO: by priority.
    #[default]
    Fifo,
    /// SCHED_DEADLINE: earliest deadline first, from the periods.
    Deadline,
}

/// How the creature halts.
#[derive(Clone, Debug, PartialEq)]
pub struct Halt {
    /// Outputs whose messages stop the body's forward motion, on a channel that nothing can tap.
    pub reflexes: Vec<PortName>,
    /// How long a reflex holds after its message.
    pub hold: Span,
    /// How old a command to the body may be.
    pub stale: Span,
    /// A hardware watchdog that is fed while all is well, an absolute path.
    pub watchdog_device: Option<std::path::PathBuf>,
}

/// What processes outside the daemon may do. Its own user may always plug in, others only if named here.
#[derive(Clone, Debug, PartialEq)]
pub struct Outsiders {
    /// Wires that may be read.
    pub read: Reads,
    /// Ports that may be tapped: inputs may be suppressed, outputs inhibited.
    pub tap: Vec<PortName>,
    /// Further users who may plug in.
    pub users: Vec<Account>,
    /// Groups whose members may plug in.
    pub groups: Vec<Account>,
    /// Most layers attached at once.
    pub layers_max: usize,
    /// Highest level an attached layer may claim.
    pub level_max: u8,
    /// Shortest time constant of an attached tap.
    pub time_constant_min: Span,
    /// Longest time constant of an attached tap.
    pub time_constant_max: Span,
    /// Most messages a second of an attached tap.
    pub messages_max: u32,
}

/// The wires that outsiders may read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reads {
    /// Every wire.
    All,
    /// Those of these outputs.
    These(Vec<PortName>),
}

/// A user or a group of the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Account {
    /// By name; whether the host knows it is seen when the daemon starts.
    Name(String),
    /// By number.
    Id(u32),
}

impl std::fmt::Display for Account {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Account::Name(name) => f.write_str(name),
            Account::Id(id) => write!(f, "{id}"),
        }
    }
}
