//! Gauges: what is counted at a tap, for those who watch from other threads.
//!
//! Must never make the thread that owns the port wait for them.

use std::sync::atomic::{AtomicU64, Ordering};

/// Counters of a tap that other threads may look at.
#[derive(Debug, Default)]
pub struct TapGauge {
    number: u16,
    pub(super) delivered: AtomicU64,
    pub(super) rejected: AtomicU64,
    pub(super) faults: AtomicU64,
}

impl TapGauge {
    /// The counters of the tap that those who trace know by `number`.
    pub fn numbered(number: u16) -> TapGauge {
        TapGauge {
            number,
            ..TapGauge::default()
        }
    }

    /// The number that those who trace know the tap by; 0 if it was given none.
    pub fn number(&self) -> u16 {
        self.number
    }

    /// Takes over what another process counted at the tap. Counts never run back, whatever it says.
    pub fn take_over(&self, counts: TapCounts) {
        // Relaxed: numbers to look at; nothing hangs on their order.
        self.delivered.fetch_max(counts.delivered, Ordering::Relaxed);
        self.rejected.fetch_max(counts.rejected, Ordering::Relaxed);
        self.faults.fetch_max(counts.faults, Ordering::Relaxed);
    }

    /// What was counted so far.
    pub fn counts(&self) -> TapCounts {
        // Relaxed: numbers to look at; nothing hangs on their order.
        TapCounts {
            delivered: self.delivered.load(Ordering::Relaxed),
            rejected: self.rejected.load(Ordering::Relaxed),
            faults: self.faults.load(Ordering::Relaxed),
        }
    }
}

/// Counts one more. Only the thread that owns the port counts, so load and store need not be one step.
pub(super) fn count(counter: &AtomicU64) {
    counter.store(counter.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
}

/// What was counted at one tap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TapCounts {
    /// Messages of the tap that took effect.
    pub delivered: u64,
    /// Messages of the wire that the tap's windows rejected or dropped.
    pub rejected: u64,
    /// Messages of the tap that were no message: not a number, out of range, or stamped in the future.
    pub faults: u64,
}

impl std::ops::Add for TapCounts {
    type Output = TapCounts;

    /// Both together; at its largest it stays.
    fn add(self, other: TapCounts) -> TapCounts {
        TapCounts {
            delivered: self.delivered.saturating_add(other.delivered),
            rejected: self.rejected.saturating_add(other.rejected),
            faults: self.faults.saturating_add(other.faults),
        }
    }
}
