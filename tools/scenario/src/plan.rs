//! A scenario as checked: what happens when, and what must come of it.
//!
//! Must never be made but by the checker ([`crate::read`]): every name in it is known to the creature.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use daemon::virtual_run::{Manifest, Stimulus};
use ipc::clock::Span;
use ipc::message::{Kind, Words};
use ipc::wiring::{Creature, Source};

/// A checked scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its file.
    pub path: PathBuf,
    /// The file's text, for reports that point into it.
    pub source: Source,
    /// What it is about, in a sentence.
    pub title: String,
    /// More about it.
    pub about: Option<String>,
    /// The creature, of which only the layers wanted are left.
    pub creature: Creature,
    /// Whether the creature's own world is behind its body.
    pub world: bool,
    /// Where the body starts.
    pub start: Option<(f64, f64, f64)>,
    /// How long it runs.
    pub duration: Span,
    /// Highest level it needs.
    pub level: u8,
    /// Whether it must hold whatever layers above its level do.
    pub competence: bool,
    /// The layers that may join, by name.
    pub manifests: BTreeMap<String, Arc<Manifest>>,
    /// Of those the ones that may also be refused, as what they tap may not be there: guests nobody counts on.
    pub strangers: Vec<String>,
    /// What happens, in order of time.
    pub stimuli: Vec<(Span, Stimulus)>,
    /// What must come of it, in the order of the file.
    pub expectations: Vec<Expectation>,
}

/// An expectation with its place.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// Where it stands in the file.
    pub at: Range<usize>,
    /// Why it is expected.
    pub because: Option<String>,
    /// What is expected.
    pub what: What,
}

/// What is expected.
#[derive(Clone, Debug)]
pub enum What {
    /// Messages on a wire, or delivered to an input.
    Messages(Messages),
    /// The first message of each of some wires comes in this order.
    Order {
        /// The wires.
        wires: Vec<String>,
        /// When.
        window: Window,
    },
    /// A module is in a state.
    State {
        /// The module.
        module: String,
        /// The state.
        state: String,
        /// When; at the end if `None`.
        at: Option<Span>,
    },
    /// The gate is closed, or open.
    Halted {
        /// Whether it is closed.
        halted: bool,
        /// For what.
        cause: Option<String>,
        /// When; at the end if `None`.
        at: Option<Span>,
    },
    /// A tap's window holds or not, or its counts.
    Tap {
        /// The output its messages come from.
        from: String,
        /// The port it acts on.
        to: String,
        /// Whether its window holds.
        holds: Option<bool>,
        /// When; at the end if `None`.
        at: Option<Span>,
        /// How many of its messages took effect.
        delivered: Option<Count>,
        /// How many messages its windows rejected or dropped.
        rejected: Option<Count>,
    },
    /// A layer is not let in.
    Refused {
        /// Its name among the manifests.
        layer: String,
        /// What the reasons say, among other things.
        saying: Option<String>,
    },
}

/// What is expected of the messages of one port.
#[derive(Clone, Debug)]
pub struct Messages {
    /// The output port after which the wire is named, or the input port.
    pub port: String,
    /// Whether messages delivered to an input are meant.
    pub input: bool,
    /// Kind of message.
    pub kind: Kind,
    /// When.
    pub window: Window,
    /// The value in question.
    pub value: Option<Words>,
    /// How many of its numbers are compared: those the file gives.
    pub compared: usize,
    /// How far each number may be off.
    pub tolerance: f64,
    /// How many of them.
    pub rule: Rule,
}

/// How many messages there must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// At least one (of that value).
    Some,
    /// None (of that value).
    None,
    /// So many (of that value).
    Count(Count),
    /// At least one, and every one has the value.
    All,
    /// The newest one has the value.
    Last,
}

/// How many there may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// At least.
    pub min: u64,
    /// At most.
    pub max: u64,
}

impl Count {
    /// Whether `n` is within.
    pub fn holds(self, n: u64) -> bool {
        (self.min..=self.max).contains(&n)
    }
}

impl std::fmt::Display for Count {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.min, self.max) {
            (min, max) if min == max => write!(f, "{min}"),
            (min, u64::MAX) => write!(f, "at least {min}"),
            (0, max) => write!(f, "at most {max}"),
            (min, max) => write!(f, "{min} to {max}"),
        }
    }
}

/// A part of a run: from `from`, which is in it, to `to`, which is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First moment.
    pub from: Span,
    /// The moment after the last.
    pub to: Span,
    /// How the file says it.
    pub said: Said,
}

/// How a window was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Said {
    /// A moment, with a tolerance.
    At(Span, Span),
    /// From and to.
    Within,
    /// Not at all: the whole run.
    Whole,
}

impl Window {
    /// Whether the moment lies in it.
    pub fn holds(self, at: Span) -> bool {
        self.from <= at && at < self.to
    }
}

impl std::fmt::Display for Window {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.said {
            Said::At(at, Span::ZERO) => write!(f, "at {at}"),
            Said::At(at, tolerance) => write!(f, "at {at} ± {tolerance}"),
            Said::Within => write!(f, "from {} until before {}", self.from, self.to),
            Said::Whole => write!(f, "in the whole run"),
        }
    }
}
