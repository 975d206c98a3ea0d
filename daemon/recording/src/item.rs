//! Items: what happens, as it passes from the daemon's threads to a recording.
//!
//! Must never be large where there are many: beats stay as they were traced until somebody writes them down.

use std::sync::Arc;

use afsm::trace;
use ipc::clock::Time;
use ipc::control::Event;
use ipc::message::Kind;
use ipc::wire::{Fate, Reading};

use crate::manifest::Plugged;

/// Something that happened.
#[derive(Clone, Debug)]
pub enum Item {
    /// What was before everything else: see [`Base`].
    Base(Arc<Base>),
    /// A source has beaten.
    Beat {
        /// The source.
        source: u16,
        /// The beat, as traced.
        words: Arc<[u64]>,
    },
    /// A message on a wire of an attached layer.
    Wire {
        /// The layer's number.
        plug: u32,
        /// The wire, in the layer's own order.
        index: usize,
        /// The kind of message.
        kind: Kind,
        /// The message.
        reading: Box<Reading>,
    },
    /// A layer was attached.
    Plugged(Time, Arc<Plugged>),
    /// A layer has left.
    Unplugged(Time, u32),
    /// A source ran over its period.
    Overrun {
        /// The source.
        source: u16,
        /// When it was noticed.
        time: Time,
        /// How often so far.
        overruns: u64,
        /// Beats left out for it so far.
        skipped: u64,
    },
    /// Beats of a source were lost before they could be recorded.
    Lost {
        /// The source.
        source: u16,
        /// When it was noticed.
        time: Time,
        /// How many so far.
        beats: u64,
    },
    /// A line of the log.
    Log(Time, Arc<Event>),
}

/// What one source held when a recording begins in the middle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Base {
    /// The source.
    pub source: u16,
    /// Its newest beat before the recording: number and times of step and commit.
    pub beat: (u64, Time, Time),
    /// The newest message of each outlet.
    pub wrote: Vec<Option<Held>>,
    /// The newest message that each register took in from its wire.
    pub saw: Vec<Option<(Held, Fate)>>,
    /// The newest message of each tap that a port took in.
    pub taps: Vec<(u16, Held, Fate)>,
    /// What the body was told last, by input.
    pub passed: Vec<Option<Held>>,
    /// The causes for which the gate was closed.
    pub causes: u64,
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// Its number on its wire.
    pub number: u64,
    /// When it was written; unknown if its words are.
    pub stamp: Time,
    /// What it says; `None` if that is not known any more.
    pub words: Option<Vec<f64>>,
}

impl Item {
    /// When it happened.
    pub fn time(&self) -> Time {
        match self {
            Item::Base(base) => base.beat.2,
            Item::Beat { words, .. } => trace::times(words).2,
            Item::Wire { reading, .. } => reading.stamp,
            Item::Plugged(time, _) | Item::Unplugged(time, _) | Item::Log(time, _) => *time,
            Item::Overrun { time, .. } | Item::Lost { time, .. } => *time,
        }
    }

    /// About how many bytes of memory it takes.
    pub fn bytes(&self) -> usize {
        let beyond = match self {
            Item::Beat { words, .. } => 16 + 8 * words.len(),
            Item::Wire { .. } => size_of::<Reading>(),
            Item::Log(_, event) => size_of::<Event>() + event.text.len() + 64,
            Item::Plugged(..) => 4096,
            _ => 0,
        };
        size_of::<Item>() + beyond
    }
}
