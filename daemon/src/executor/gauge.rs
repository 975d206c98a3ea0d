//! Gauges: what a beating thread shows to those who watch it.
//!
//! Must never make the beating thread wait: counters are written by that thread alone, and samples that
//! find their ring full are counted as lost. What each number means is written down in `docs/timing.md`.

use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::{Span, Time};

use super::deadline::Verdict;

/// Counters of one beating layer. Written by its thread alone, read by anyone; the numbers are to look
/// at, so every access is relaxed, but for `last` which the halt gate relies on being recent, not ordered.
#[derive(Debug, Default)]
pub struct BeatGauge {
    beats: AtomicU64,
    skipped: AtomicU64,
    overruns: AtomicU64,
    missed: AtomicU64,
    missed_in_row: AtomicU64,
    missed_in_row_max: AtomicU64,
    identity_faults: AtomicU64,
    last: AtomicU64,
    lost_samples: AtomicU64,
}

/// A copy of the counters of a [`BeatGauge`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeatCounts {
    /// Beats that ran.
    pub beats: u64,
    /// Beats left out because an earlier one missed its deadline.
    pub skipped: u64,
    /// Beats whose own run took longer than a period.
    pub overruns: u64,
    /// Beats that ended after their deadline, the moment the next one is due; a late release counts.
    pub missed: u64,
    /// Deadlines missed in a row, up to the last beat.
    pub missed_in_row: u64,
    /// The longest such row so far.
    pub missed_in_row_max: u64,
    /// Beats after which elapsed / period was not beats + skipped. Always zero.
    pub identity_faults: u64,
    /// When the last beat ended; zero if none did.
    pub last: Time,
    /// Samples that found their ring full.
    pub lost_samples: u64,
}

impl BeatGauge {
    /// Counts a beat that ended in time, at `now`.
    pub fn beat(&self, now: Time) {
        self.judged(now, Verdict::default(), true);
    }

    /// Counts a beat that ended at `now` with `verdict`; `sound` says whether the identity holds after it.
    pub fn judged(&self, now: Time, verdict: Verdict, sound: bool) {
        add(&self.beats, 1);
        add(&self.skipped, verdict.skip);
        add(&self.overruns, u64::from(verdict.overrun));
        add(&self.identity_faults, u64::from(!sound));
        self.count_row(verdict.missed);
        self.last.store(now.0, Ordering::Relaxed);
    }

    fn count_row(&self, missed: bool) {
        if !missed {
            self.missed_in_row.store(0, Ordering::Relaxed);
            return;
        }
        add(&self.missed, 1);
        add(&self.missed_in_row, 1);
        let row = self.missed_in_row.load(Ordering::Relaxed);
        if row > self.missed_in_row_max.load(Ordering::Relaxed) {
            self.missed_in_row_max.store(row, Ordering::Relaxed);
        }
    }

    /// Counts a lost sample.
    pub fn lose_sample(&self) {
        add(&self.lost_samples, 1);
    }

    /// The counters now.
    pub fn counts(&self) -> BeatCounts {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        BeatCounts {
            beats: read(&self.beats),
            skipped: read(&self.skipped),
            overruns: read(&self.overruns),
            missed: read(&self.missed),
            missed_in_row: read(&self.missed_in_row),
            missed_in_row_max: read(&self.missed_in_row_max),
            identity_faults: read(&self.identity_faults),
            last: Time(read(&self.last)),
            lost_samples: read(&self.lost_samples),
        }
    }
}

/// One thread writes, so load and store need not be one step.
fn add(counter: &AtomicU64, n: u64) {
    counter.store(counter.load(Ordering::Relaxed) + n, Ordering::Relaxed);
}

/// What was measured at one beat of one layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// When the beat was due.
    pub due: Time,
    /// From then to the moment the thread ran.
    pub latency: Span,
    /// How long the layer's own step took, from looking at its registers to having written its wires.
    pub step: Span,
    /// From the moment the beat was due to its end: what is held against the deadline.
    pub response: Span,
}

/// Samples between two looks of the watcher, ten a second, at a period of 100 µs, four times over.
pub const SAMPLES_MAX: usize = 4096;
