//! The body channel: how a daemon and the process that runs its body find each other.
//!
//! ```text
//!   daemon                                 body process, listening at <run>/NAME.body
//!     │── Hello: versions, contract, where its commands are ──►│ checks, maps the daemon's page
//!     │◄── Welcome: where its sensors are ─────────────────────│
//!     │   maps the body's page; from now on commands and sensors cross in shared memory
//!     │── View, now and then, for those who watch ────────────►│
//! ```
//! JSON lines like the [control channel](crate::control). One daemon drives a body at a time; the connection
//! says who, and its end that the driver left.
//!
//! Must never carry commands or sensor values, nor be needed for a halt: either end halts by stamps alone.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::clock::Span;
use crate::control::{Versions, socket_in_run_dir};
use crate::message::Kind;
use crate::wiring::{Declaration, Port};

/// Longest line on a body channel: the plan of a large floor takes about 100 KiB.
pub const BODY_LINE_MAX: usize = 1 << 20;

/// A port as both ends must know it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortContract {
    /// Its name.
    pub name: String,
    /// The kind of message.
    pub kind: Kind,
    /// Its unit.
    pub unit: String,
    /// Bits of the smallest and the largest value: numbers may change their last digit on the way.
    pub limits: (u64, u64),
}

/// What a body is, as both ends must know it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Contract {
    /// The kind of body.
    pub kind: String,
    /// Commands, in the order of their cells.
    pub inputs: Vec<PortContract>,
    /// Sensors, in the order of their cells.
    pub outputs: Vec<PortContract>,
}

impl Contract {
    /// That of a kind of body as this program knows it.
    pub fn of(declaration: &Declaration) -> Contract {
        let port = |p: &Port| PortContract {
            name: p.name.into(),
            kind: p.kind,
            unit: p.unit.into(),
            limits: (p.low.to_bits(), p.high.to_bits()),
        };
        Contract {
            kind: declaration.name.into(),
            inputs: declaration.inputs.iter().map(port).collect(),
            outputs: declaration.outputs.iter().map(port).collect(),
        }
    }

    /// Why a body of this contract cannot be driven by a program that expects `other`, if it cannot.
    pub fn against(&self, other: &Contract) -> Option<String> {
        if self == other {
            return None;
        }
        if self.kind != other.kind {
            return Some(format!(
                "the body is of kind {:?}, the creature wants {:?}",
                self.kind, other.kind
            ));
        }
        Some(format!(
            "both ends know the kind {:?}, but with other ports: build both from one version",
            self.kind
        ))
    }
}

/// What a daemon asks of a body process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "ask")]
pub enum Ask {
    /// First on every connection.
    Hello {
        /// The daemon's versions.
        versions: Versions,
        /// The creature it runs.
        creature: String,
        /// Who shares the page in which its commands are (see `wire::iceoryx::service_of`).
        owner: String,
        /// The cell of the first command; the others follow in the contract's order.
        first: usize,
        /// The body it expects.
        contract: Contract,
    },
    /// How the world looks now.
    View,
}

/// What a body process answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "answer")]
pub enum Answer {
    /// The daemon may drive this body.
    Welcome {
        /// Who shares the page in which its sensors are, and after them its pulse.
        owner: String,
        /// Time between two turns of its world.
        period: Span,
        /// Its process.
        pid: u32,
        /// What of the world does not change.
        floor: serde_json::Value,
    },
    /// How the world looks.
    View {
        /// As the live page shows it.
        view: serde_json::Value,
    },
    /// Not done, and why.
    Refused {
        /// The reasons.
        reasons: Vec<String>,
    },
}

/// Under what name the process that runs body `name` shares its sensors. No creature or layer can be called
/// so: their names hold no colon.
pub fn owner_of(name: &str) -> String {
    format!("body:{name}")
}

/// The socket of the process that runs body `name`.
pub fn body_socket(name: &str) -> PathBuf {
    socket_in_run_dir(name, "body")
}

/// The kind of message in which a body process shows that it lives: see [`Pulse`].
pub const PULSE_KIND: Kind = Kind::Vector;

/// What a body says of itself each turn, in the cell after its sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pulse {
    /// Why its own gate is closed: bits of the daemon's `Causes`; zero when it is open.
    pub causes: u32,
    /// How often it has closed.
    pub closings: u32,
}

impl Pulse {
    /// As words.
    pub fn pack(self) -> crate::message::Words {
        let mut words = [0.0; crate::message::WORDS_MAX];
        words[0] = f64::from(self.causes);
        words[1] = f64::from(self.closings);
        words
    }

    /// From words, whatever they hold.
    pub fn unpack(words: &crate::message::Words) -> Pulse {
        // Casts from floats saturate, and make zero of what is not a number.
        Pulse {
            causes: words[0] as u32,
            closings: words[1] as u32,
        }
    }
}
