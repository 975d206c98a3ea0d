//! Links: what a chain of reasons is made of, as it is shown and as JSON.
//!
//! Must never look anything up: whoever makes a link knows.

use ipc::wiring::creature::How;
use serde::Serialize;

/// A message, and what stands behind it.
#[derive(Clone, Debug, Serialize)]
pub struct Link {
    /// The wire, or the input of the body.
    pub wire: String,
    /// The message's number.
    pub number: u64,
    /// When it was written, in seconds since the daemon began.
    pub time_s: f64,
    /// How old it was when it was looked at, in milliseconds.
    pub age_ms: f64,
    /// What it says.
    pub value: Vec<f64>,
    /// Its unit, or empty.
    pub unit: String,
    /// The module that wrote it; none for the body.
    pub module: Option<String>,
    /// Its layer; the motor unit for what the body says and is told.
    pub layer: String,
    /// The layer's level.
    pub level: Option<u8>,
    /// The process, if it is not the daemon's.
    pub pid: Option<u32>,
    /// Why the halt gate was closed, for what the body was told.
    pub halted: Vec<String>,
    /// Whether the inputs are what the beat looked at, not what stamps suggest.
    pub traced: bool,
    /// How many messages of the wire were inhibited since, until it was looked at.
    pub inhibited: u64,
    /// Whether it was explained before, further up.
    pub above: bool,
    /// What its module held.
    pub inputs: Vec<Input>,
}

/// A register of the module, as the beat found it.
#[derive(Clone, Debug, Serialize)]
pub struct Input {
    /// The port.
    pub port: String,
    /// Whether its message had arrived just then.
    pub arrived: bool,
    /// The tap that brought it, if one did.
    pub tap: Option<String>,
    /// Taps on the port, and whether they held.
    pub taps: Vec<TapSeen>,
    /// How many messages of its own wire were rejected since the one it held came.
    pub rejected: u64,
    /// The newest of them.
    pub newest_rejected: Option<Rejected>,
    /// The message it held; none if it never had one.
    pub held: Option<Box<Link>>,
}

/// A message that a tap's window kept out.
#[derive(Clone, Debug, Serialize)]
pub struct Rejected {
    /// Its wire.
    pub wire: String,
    /// Its number.
    pub number: u64,
    /// How old it was, in milliseconds; none if it is not known any more.
    pub age_ms: Option<f64>,
    /// What it said.
    pub value: Vec<f64>,
}

/// A tap, as it stood at some moment.
#[derive(Clone, Debug, Serialize)]
pub struct TapSeen {
    /// Its layer.
    pub layer: String,
    /// Its level.
    pub level: u8,
    /// The wire that its messages come from.
    pub from: String,
    /// Which way it acts.
    pub kind: How,
    /// Whether its window held.
    pub holds: bool,
    /// For how long still, in milliseconds.
    pub left_ms: f64,
    /// How old its newest message was; none if it never had one.
    pub age_ms: Option<f64>,
}
