//! Channels: where each wire goes in a recording, and how much of it went there.
//!
//! Must never forget a message that is missing: numbers run without a gap.

use std::collections::VecDeque;

use ipc::message::Kind;

/// Messages of one wire of an attached layer that are remembered, to know those again that come twice.
const RECENT_MAX: usize = 256;

/// A wire and what was written of it.
pub(super) struct WireChannel {
    pub(super) name: String,
    pub(super) id: u16,
    pub(super) kind: Kind,
    first: u64,
    last: u64,
    pub(super) written: u64,
    recent: VecDeque<u64>,
}

impl WireChannel {
    /// A wire of which nothing was written yet.
    pub(super) fn new(name: &str, id: u16, kind: Kind) -> WireChannel {
        WireChannel {
            name: name.into(),
            id,
            kind,
            first: 0,
            last: 0,
            written: 0,
            recent: VecDeque::new(),
        }
    }

    pub(super) fn lost(&self) -> u64 {
        (self.last + 1 - self.first).saturating_sub(self.written)
    }

    /// Whether message `number` is new, and if so, counts it.
    pub(super) fn takes(&mut self, number: u64) -> bool {
        if self.recent.contains(&number) {
            return false;
        }
        if self.recent.len() == RECENT_MAX {
            self.recent.pop_front();
        }
        self.recent.push_back(number);
        self.count(number);
        true
    }

    pub(super) fn count(&mut self, number: u64) {
        if self.written == 0 {
            self.first = number;
        }
        self.first = self.first.min(number);
        self.last = self.last.max(number);
        self.written += 1;
    }
}

pub(super) struct SourceChannels {
    pub(super) beats: u16,
    pub(super) outputs: Vec<WireChannel>,
    pub(super) commands: Vec<(u16, Kind)>,
}

pub(super) struct PlugChannels {
    pub(super) layer: String,
    pub(super) outputs: Vec<WireChannel>,
}
