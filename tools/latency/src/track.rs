//! Tracks: what was measured of one layer in one respect, interval by interval.
//!
//! Must never average away a tail: every sample lands in a histogram, from 1 ns to 100 s, to three digits.

use std::time::Duration;

use hdrhistogram::Histogram;

/// Longest time that is told apart, in nanoseconds.
pub const LONGEST_NS: u64 = 100_000_000_000;

/// Digits kept of every number.
const DIGITS: u8 = 3;

/// An empty histogram of nanoseconds.
///
/// # Panics
/// Never: the bounds are sound.
pub fn histogram() -> Histogram<u64> {
    Histogram::new_with_bounds(1, LONGEST_NS, DIGITS).expect("sound bounds")
}

/// What one interval measured.
#[derive(Clone, Debug)]
pub struct Interval {
    /// When it began, from the beginning of the run.
    pub began: Duration,
    /// How long it was.
    pub length: Duration,
    /// What was measured in it, in nanoseconds.
    pub histogram: Histogram<u64>,
}

/// One respect of one layer.
#[derive(Clone, Debug)]
pub struct Track {
    /// Whose: a layer, a thread, a program.
    pub of: String,
    /// In what respect: `wake-up`, `step`, `period-error`, `age`, `response`.
    pub metric: &'static str,
    /// Everything measured, in nanoseconds.
    pub total: Histogram<u64>,
    /// Piece by piece.
    pub intervals: Vec<Interval>,
}

impl Track {
    /// Nothing measured yet.
    pub fn new(of: impl Into<String>, metric: &'static str) -> Track {
        Track {
            of: of.into(),
            metric,
            total: histogram(),
            intervals: Vec::new(),
        }
    }

    /// The name it has in files: `layer.metric`.
    pub fn name(&self) -> String {
        format!("{}.{}", self.of, self.metric)
    }

    /// Adds an interval.
    ///
    /// # Panics
    /// Never: all histograms have one shape.
    pub fn add(&mut self, began: Duration, length: Duration, measured: Histogram<u64>) {
        self.total.add(&measured).expect("one shape");
        self.intervals.push(Interval {
            began,
            length,
            histogram: measured,
        });
    }

    /// Adds an interval given everything measured since the beginning of the run.
    ///
    /// # Panics
    /// Never: what was measured before is part of what was measured since.
    pub fn add_up_to(&mut self, began: Duration, length: Duration, since_start: &Histogram<u64>) {
        let mut fresh = histogram();
        fresh.add(since_start).expect("one shape");
        fresh.subtract(&self.total).expect("histograms only grow");
        self.add(began, length, fresh);
    }
}

/// The quantiles that reports show, with their names.
pub const QUANTILES: [(&str, f64); 4] = [("p50", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("p99.99", 0.9999)];

/// A time in microseconds with as many digits as mean something.
pub fn micros(ns: u64) -> String {
    let us = ns as f64 / 1e3;
    match us {
        _ if us < 10.0 => format!("{us:.2}"),
        _ if us < 100.0 => format!("{us:.1}"),
        _ => format!("{us:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_add_up_to_the_total() {
        let mut track = Track::new("avoid", "step");
        let mut all = histogram();
        for k in 0..5_u64 {
            (0..=k).for_each(|n| all.saturating_record(1_000 * (n + 1)));
            track.add_up_to(Duration::from_secs(k), Duration::from_secs(1), &all);
        }
        assert_eq!(track.total.len(), 15);
        let lengths: Vec<u64> = track.intervals.iter().map(|i| i.histogram.len()).collect();
        assert_eq!(lengths, [1, 2, 3, 4, 5]);
        assert_eq!(track.name(), "avoid.step");
    }

    #[test]
    fn micros_keep_three_digits() {
        assert_eq!(
            [micros(254), micros(12_345), micros(9_876_543)],
            ["0.25", "12.3", "9877"]
        );
    }
}
