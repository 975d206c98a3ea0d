//! The gate: what a run must show to pass.
//!
//! Must never judge an absolute time on a shared machine: times are judged as ratios to the reference beside
//! them, at the margins of [`LIMITS`], never below what two of our own threads differ by in the same run, and failed
//! only where the rounds leave no doubt: one round that met a machine standing still is not ours.
//!
//! The margins: a good loop's worst of many short runs on a noisy two-processor host were 1.18, 1.51 and 1.31 at
//! p50, p99 and p99.9, with a spread of ×1.10 to ×1.13; a loop without SCHED_FIFO has 3.3, 27 and 10 to 36.
//! Limits of 1.5, 2 and 2 lie three spreads outside the one and far inside the other.

use serde::Serialize;

use crate::creature::Kept;
use crate::ratio::Ratio;

/// Quantile, its name, the largest geometric mean of the ratios that passes.
pub const LIMITS: [(f64, &str, f64); 3] = [(0.5, "p50", 1.5), (0.99, "p99", 2.0), (0.999, "p99.9", 2.0)];

/// What a comparison showed at one quantile.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// What was compared, such as `wake-up, sleep / cyclictest`.
    pub what: String,
    /// At which quantile.
    pub quantile: &'static str,
    /// The ratios of the rounds.
    pub ratio: Ratio,
    /// The limit that holds for the geometric mean in this run; none for what is only reported.
    pub limit: Option<f64>,
}

impl Compared {
    /// What is to be thought of it; none of what is only reported.
    pub fn verdict(&self) -> Option<Verdict> {
        let limit = self.limit?;
        Some(if self.ratio.mean <= limit {
            Verdict::Passes
        } else if self.ratio.at_least() <= limit {
            Verdict::Doubtful
        } else {
            Verdict::Fails
        })
    }
}

/// What a comparison's rounds say of its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The geometric mean is within it.
    Passes,
    /// The mean is not, but so few and so different rounds may be chance.
    Doubtful,
    /// The mean is outside with 95 % confidence.
    Fails,
}

impl Verdict {
    /// As a cell of the table.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Passes => "passes",
            Verdict::Doubtful => "too few rounds to say",
            Verdict::Fails => "**fails**",
        }
    }
}

/// The limit at a quantile given what the control showed there: outside of what two equal threads differ by.
pub fn limit(base: f64, control: Option<&Ratio>) -> f64 {
    let noise = control.map_or(1.0, |c| c.mean.max(1.0 / c.mean) * c.spread.powi(2));
    base.max(noise)
}

/// What is wrong with a run, in words; empty if it passes.
pub fn faults(compared: &[Compared], kept: &[Kept], allocations: u64, refusals: &[String]) -> Vec<String> {
    let mut faults: Vec<String> = refusals
        .iter()
        .map(|r| format!("not in real time: {r}"))
        .collect();
    if allocations > 0 {
        faults.push(format!(
            "{allocations} allocations or releases on real-time threads"
        ));
    }
    for k in kept {
        if k.faults > 0 {
            faults.push(format!("{} page faults on {}", k.faults, k.thread));
        }
        if k.sleeps > k.beats {
            faults.push(format!(
                "{} gave the processor away {} times in {} beats: it waits for something other than its beat",
                k.thread, k.sleeps, k.beats
            ));
        }
        if k.identity_faults > 0 {
            faults.push(format!("{}: beats and skipped beats do not add up", k.thread));
        }
    }
    for c in compared.iter().filter(|c| c.verdict() == Some(Verdict::Fails)) {
        faults.push(format!(
            "{} at {}: geometric mean {:.2}, at least {:.2}, limit {:.2}",
            c.what,
            c.quantile,
            c.ratio.mean,
            c.ratio.at_least(),
            c.limit.unwrap_or(f64::INFINITY)
        ));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept() -> Kept {
        Kept {
            thread: "relay".into(),
            tid: 1,
            beats: 1000,
            missed: 3,
            missed_in_row_max: 1,
            skipped: 3,
            identity_faults: 0,
            faults: 0,
            sleeps: 999,
        }
    }

    fn compared(ratio: f64) -> Compared {
        Compared {
            what: "wake-up".into(),
            quantile: "p99",
            ratio: Ratio::of(&[ratio, ratio]).unwrap(),
            limit: Some(2.0),
        }
    }

    #[test]
    fn a_good_run_passes() {
        assert_eq!(faults(&[compared(1.4)], &[kept()], 0, &[]), Vec::<String>::new());
    }

    #[test]
    fn one_bad_round_among_few_is_a_doubt_and_many_are_a_fault() {
        let verdict = |rounds: &[f64]| {
            let ratio = Ratio::of(rounds).unwrap();
            Compared {
                ratio,
                ..compared(1.0)
            }
            .verdict()
        };
        assert_eq!(verdict(&[1.0, 1.1, 0.9, 1.0]), Some(Verdict::Passes));
        assert_eq!(verdict(&[13.1, 7.0, 1.1, 2.1]), Some(Verdict::Doubtful));
        assert_eq!(verdict(&[13.1, 7.0, 1.1, 2.1].repeat(3)), Some(Verdict::Fails));
        assert_eq!(verdict(&[4.0, 5.0, 6.0, 5.0]), Some(Verdict::Fails));
    }

    #[test]
    fn each_fault_alone_fails() {
        let one = |compared: f64, kept: Kept, allocations, refusals: &[String]| {
            faults(&[self::compared(compared)], &[kept], allocations, refusals).len()
        };
        assert_eq!(one(2.1, kept(), 0, &[]), 1);
        assert_eq!(one(1.0, kept(), 1, &[]), 1);
        assert_eq!(one(1.0, kept(), 0, &["sched_setscheduler".into()]), 1);
        assert_eq!(one(1.0, Kept { faults: 1, ..kept() }, 0, &[]), 1);
        assert_eq!(
            one(
                1.0,
                Kept {
                    sleeps: 1001,
                    ..kept()
                },
                0,
                &[]
            ),
            1
        );
        assert_eq!(
            one(
                1.0,
                Kept {
                    identity_faults: 1,
                    ..kept()
                },
                0,
                &[]
            ),
            1
        );
    }

    #[test]
    fn a_limit_lies_outside_of_what_equal_threads_differ_by() {
        let quiet = Ratio::of(&[1.0, 1.05, 0.95]).unwrap();
        assert_eq!(limit(1.5, Some(&quiet)), 1.5);
        let noisy = Ratio::of(&[3.0, 0.5, 1.5]).unwrap();
        assert!(limit(1.5, Some(&noisy)) > 3.0);
        assert_eq!(limit(2.0, None), 2.0);
    }
}
