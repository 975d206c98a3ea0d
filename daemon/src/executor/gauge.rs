//! Gauges: what a beating thread shows to those who watch it.
//!
//! Must never make the beating thread wait: counters are written by that thread alone, and samples that
//! find their ring full are counted as lost.

use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::{Span, Time};

/// Counters of one beating thread. Written by that thread alone, read by anyone; the numbers are to look
/// at, so every access is relaxed, but for `last` which the halt gate relies on being recent, not ordered.
#[derive(Debug, Default)]
pub struct BeatGauge {
    beats: AtomicU64,
    skipped: AtomicU64,
    overruns: AtomicU64,
    last: AtomicU64,
    lost_samples: AtomicU64,
}

/// A copy of the counters of a [`BeatGauge`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeatCounts {
    /// Beats that ran.
    pub beats: u64,
    /// Beats left out because an earlier one ran over its period.
    pub skipped: u64,
    /// Beats that ended after the next one was due.
    pub overruns: u64,
    /// When the last beat ended; zero if none did.
    pub last: Time,
    /// Samples that found their ring full.
    pub lost_samples: u64,
}

impl BeatGauge {
    /// Counts a beat that ended at `now`.
    pub fn beat(&self, now: Time) {
        add(&self.beats, 1);
        self.last.store(now.0, Ordering::Relaxed);
    }

    /// Counts an overrun after which `skipped` beats were left out.
    pub fn overrun(&self, skipped: u64) {
        add(&self.overruns, 1);
        add(&self.skipped, skipped);
    }

    /// Counts a lost sample.
    pub fn lose_sample(&self) {
        add(&self.lost_samples, 1);
    }

    /// The counters now.
    pub fn counts(&self) -> BeatCounts {
        BeatCounts {
            beats: self.beats.load(Ordering::Relaxed),
            skipped: self.skipped.load(Ordering::Relaxed),
            overruns: self.overruns.load(Ordering::Relaxed),
            last: Time(self.last.load(Ordering::Relaxed)),
            lost_samples: self.lost_samples.load(Ordering::Relaxed),
        }
    }
}

/// One thread writes, so load and store need not be one step.
fn add(counter: &AtomicU64, n: u64) {
    counter.store(counter.load(Ordering::Relaxed) + n, Ordering::Relaxed);
}

/// What was measured at one beat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// From the moment the beat was due to the moment the thread ran.
    pub latency: Span,
    /// From then to the end of the beat.
    pub step: Span,
}

/// Samples between two looks of the watcher, ten a second, at a period of 100 µs, four times over.
pub const SAMPLES_MAX: usize = 4096;
