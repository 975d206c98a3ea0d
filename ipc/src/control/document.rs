//! Documents: what is said on a control connection, in either direction.
//!
//! Must never hold what only one end knows: every field is the same thing to both.

use serde::{Deserialize, Serialize};

use super::PROTOCOL;
use crate::clock::Span;
use crate::wire::iceoryx::ICEORYX2;
use crate::wire::{LAYOUT, TapCounts};
use crate::wiring::creature::How;
use crate::wiring::directory::{Directory, Listed};

/// What must be equal at both ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// Version of the control protocol.
    pub protocol: u32,
    /// Version of the wire layout.
    pub layout: u32,
    /// Version of iceoryx2.
    pub iceoryx2: String,
}

impl Versions {
    /// Those of this program.
    pub fn ours() -> Versions {
        Versions {
            protocol: PROTOCOL,
            layout: LAYOUT,
            iceoryx2: ICEORYX2.into(),
        }
    }
}

impl std::fmt::Display for Versions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "protocol {}, wire layout {}, iceoryx2 {}",
            self.protocol, self.layout, self.iceoryx2
        )
    }
}

/// What a caller may ask.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "ask")]
pub enum Request {
    /// First on every connection.
    Hello {
        /// The caller's versions.
        versions: Versions,
        /// The caller's name.
        program: String,
    },
    /// The state of everything.
    Status,
    /// The ports there are.
    Directory,
    /// Events after the `after`-th.
    Events {
        /// Number of the last event already seen; 0 for all.
        after: u64,
    },
    /// Emergency stop; holds until reset.
    Halt,
    /// Ends an emergency stop.
    Reset,
    /// Records what happens. The answer is [`Reply::Recording`], followed by the bytes of an MCAP file until the
    /// daemon closes the connection; the caller ends the recording by closing its own direction.
    Record {
        /// Whether to begin with what the flight recorder holds.
        past: bool,
        /// How long to record, in seconds; 0 for what is there already, none until the caller ends it.
        seconds: Option<f64>,
        /// Keep only the newest stretch, until the body halts.
        ring: Option<Span>,
    },
    /// Joins a layer for as long as this connection lasts.
    Plug(Plug),
    /// The joined layer leaves of its own will; no answer is waited for.
    Unplug,
    /// The joined layer has done what an order says, or says why not; there is no answer.
    Obeyed {
        /// The order's number.
        order: u64,
        /// Why it was not done, if it was not.
        refused: Option<String>,
    },
    /// What the joined layer counted so far at the taps of others on its ports, by their numbers; there is no
    /// answer.
    Counts {
        /// Each tap's number and counts.
        taps: Vec<(u16, TapCounts)>,
    },
}

/// A layer that wants to join.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plug {
    /// The layer's name.
    pub layer: String,
    /// Its level.
    pub level: u8,
    /// Time between its beats.
    pub period: Span,
    /// Its process.
    pub pid: u32,
    /// Under what name it shares its own wires.
    pub owner: String,
    /// Its own output ports, in the order of its page.
    pub outputs: Vec<Listed>,
    /// Its own input ports, without reset lines.
    #[serde(default)]
    pub inputs: Vec<Listed>,
    /// Ports of its own that other layers may tap.
    #[serde(default)]
    pub open_taps: Vec<String>,
    /// Outputs of its own whose wires other layers may read; none for all.
    #[serde(default)]
    pub open_reads: Option<Vec<String>>,
    /// The attached layers whose wires it reads, by the numbers of the comings of which it has mapped the page.
    #[serde(default)]
    pub neighbours: Vec<u32>,
    /// Its modules, for pictures.
    pub modules: Vec<PlugModule>,
    /// Wires into its modules, `from` and `to`, for pictures.
    pub wires: Vec<(String, String)>,
    /// Its taps.
    pub taps: Vec<PlugTap>,
}

/// A module of a layer that wants to join.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlugModule {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Names of its inputs.
    pub inputs: Vec<String>,
    /// Names of its outputs.
    pub outputs: Vec<String>,
}

/// A tap of a layer that wants to join.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlugTap {
    /// Which way it acts.
    pub how: How,
    /// The newcomer's output port.
    pub from: String,
    /// The creature's port.
    pub to: String,
    /// Its time constant.
    pub time_constant: Span,
}

/// What the daemon answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "answer", content = "with")]
pub enum Reply {
    /// The caller may go on.
    Welcome {
        /// The daemon's versions.
        versions: Versions,
        /// The creature's name.
        creature: String,
    },
    /// The ports there are.
    Directory(Directory),
    /// The state of everything; see the daemon's `status`.
    Status(serde_json::Value),
    /// Events, oldest first.
    Events(Vec<Event>),
    /// A recording follows, see [`Request::Record`].
    Recording,
    /// Done.
    Done,
    /// The layer is attached.
    Plugged {
        /// Its number.
        plug: u32,
    },
    /// What an attached layer is to do; it answers with [`Request::Obeyed`].
    Order {
        /// The order's number, counted from 1 on each connection.
        number: u64,
        /// What is to be done.
        order: Order,
    },
    /// Not done, and why.
    Refused {
        /// The reasons.
        reasons: Vec<String>,
    },
}

/// What a daemon tells an attached layer: what other layers have to do with its ports.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "do")]
pub enum Order {
    /// Join another layer's tap to a port.
    Join(JoinTap),
    /// Let go every tap of the layer of this number; their windows run out by themselves.
    Release {
        /// The layer's number.
        plug: u32,
    },
    /// Wires of another layer that inputs are connected to are shared anew: map its page, and connect those
    /// inputs again.
    Connect {
        /// Who shares them.
        owner: String,
        /// The wires.
        wires: Vec<Listed>,
    },
    /// A layer whose wires inputs are connected to has gone: nothing new comes on them until further orders.
    Lost {
        /// The layer's name.
        layer: String,
    },
}

/// A tap of one attached layer, to be joined to a port of another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JoinTap {
    /// The tap's number.
    pub tap: u16,
    /// The number of the layer that it comes from.
    pub plug: u32,
    /// The level of that layer.
    pub level: u8,
    /// Where its messages are.
    pub from: Listed,
    /// Which way it acts.
    pub how: How,
    /// The port.
    pub to: String,
    /// Its time constant.
    pub time_constant: Span,
}

/// Longest reason for which an order is refused, in characters; what is longer is cut.
pub const REFUSAL_MAX: usize = 200;

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Its number, counted from 1.
    pub number: u64,
    /// Seconds since the daemon started.
    pub time_s: f64,
    /// What kind of thing: `layer`, `halt`, `overrun`, `daemon`.
    pub kind: String,
    /// The layer it is about, if it is about one.
    pub layer: Option<String>,
    /// What happened, in a sentence.
    pub text: String,
}
