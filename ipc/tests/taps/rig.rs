//! Registers and outlets on pages in memory, and the histories they are run through.
//!
//! Must never decide what a tap does.
//!
//! A *history* says who wrote in which tick: bit `source` of `history[tick]`. Source 0 is the existing wire
//! (or the module that emits on it), the others are the taps in the order of declaration.

use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::message::{Kind, WORDS_MAX, Words};
use ipc::wire::{Limits, Page, Register, Room, TapEnd, TapGauge, Writer};

use crate::model::Suppressor;

/// Kinds of messages: of several words, and of one, which have ways of their own through registers and outlets.
pub(crate) const KINDS: [Kind; 2] = [Kind::Vector, Kind::Number];

pub(crate) const fn any(kind: Kind) -> Limits {
    Limits {
        kind,
        low: -1e9,
        high: 1e9,
    }
}

/// Most sources.
const SOURCES_MAX: u64 = 16;

/// A message that says when and by whom it was written, in its first word, and by whom in the second.
pub(crate) fn words(tick: u64, source: usize) -> Words {
    let mut words = [0.0; WORDS_MAX];
    words[0] = (tick * SOURCES_MAX + source as u64) as f64;
    words[1] = source as f64;
    words
}

/// When and by whom the message held of `kind` was written.
pub(crate) fn said(held: Option<(Time, Words)>, kind: Kind) -> Option<(u64, usize)> {
    held.map(|(stamp, words)| {
        let source = words[0] as u64 % SOURCES_MAX;
        assert_eq!(
            stamp.0,
            words[0] as u64 / SOURCES_MAX,
            "a message keeps its own stamp"
        );
        let second = if kind.single() { 0.0 } else { source as f64 };
        assert_eq!(words[1], second, "the words of a message belong together");
        (stamp.0, source as usize)
    })
}

pub(crate) fn end(page: &Arc<Page>, kind: Kind, wire: usize, tau: u64, level: u8, plug: u32) -> TapEnd {
    TapEnd {
        reader: page.reader(wire, kind).unwrap(),
        time_constant: Span(tau),
        level,
        plug,
        gauge: Arc::default(),
        room: Room::none(),
    }
}

pub(crate) fn writers(page: &Arc<Page>, kind: Kind) -> Vec<Writer> {
    (0..page.len())
        .map(|wire| page.writer(wire, kind).unwrap())
        .collect()
}

/// An input with its wire and taps on a page in memory.
pub(crate) struct Real {
    kind: Kind,
    pub(crate) writers: Vec<Writer>,
    pub(crate) gauges: Vec<Arc<TapGauge>>,
    pub(crate) register: Register,
}

impl Real {
    pub(crate) fn new(suppressors: &[Suppressor], kind: Kind) -> Real {
        let page = Page::in_memory(suppressors.len() + 1);
        let mut gauges = Vec::new();
        let mut register = Register::new(any(kind), page.reader(0, kind));
        for (k, s) in suppressors.iter().enumerate() {
            let end = end(&page, kind, k + 1, s.tau, s.level, 0);
            gauges.push(end.gauge.clone());
            register.suppress(end).unwrap();
        }
        Real {
            kind,
            writers: writers(&page, kind),
            gauges,
            register,
        }
    }

    pub(crate) fn write(&mut self, now: u64, source: usize) {
        self.writers[source].write(Time(now), &words(now, source));
    }

    /// When and by whom the message held was written.
    pub(crate) fn held(&self) -> Option<(u64, usize)> {
        said(self.register.held(), self.kind)
    }

    pub(crate) fn gather(&mut self, now: u64) {
        self.register
            .gather(Time(now), |_| panic!("nobody told a tap to go"));
    }
}

pub(crate) fn wrote(row: u32, source: usize) -> bool {
    row >> source & 1 == 1
}

/// Every history of `sources` sources over `ticks` ticks.
pub(crate) fn histories(sources: usize, ticks: usize) -> impl Iterator<Item = Vec<u32>> {
    let row = (1_u32 << sources) - 1;
    (0..1_u64 << (sources * ticks)).map(move |bits| {
        (0..ticks)
            .map(|tick| (bits >> (tick * sources)) as u32 & row)
            .collect()
    })
}

/// Every choice of `n` numbers from `from`.
pub(crate) fn choices(n: usize, from: &[u64]) -> Vec<Vec<u64>> {
    (0..n).fold(vec![vec![]], |all, _| {
        all.iter()
            .flat_map(|some| from.iter().map(|&x| [&some[..], &[x]].concat()))
            .collect()
    })
}

pub(crate) fn suppressors(levels: &[u64], taus: &[u64]) -> Vec<Suppressor> {
    let pairs = levels.iter().zip(taus);
    pairs
        .map(|(&level, &tau)| Suppressor {
            level: level as u8,
            tau,
        })
        .collect()
}
