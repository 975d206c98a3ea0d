//! Means with confidence intervals: a ratio of sums over seeds, its interval by bootstrap.
//!
//! Must never call chance what is the same in every seed, nor sure what was never seen: where nothing happened
//! in any seed the interval goes up to what three in a hundred and fifty would have missed (rule of three).

use afsm::random::Random;
use serde::Serialize;

/// Resamples for one interval: the ends' own error is then about a tenth of the interval.
const RESAMPLES: usize = 2000;
/// Seed of the resampling: equal figures give equal intervals.
const SEED: u64 = 1986;

/// An estimate with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Sum over sum; not a number when there was nothing to divide by.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Estimate {
    /// Whether the intervals of both have a point in common.
    pub fn meets(&self, other: &Estimate) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

/// The ratio of sums of `pairs`, one pair for each seed, with a 95 % percentile-bootstrap interval over seeds
/// (Efron 1979, Annals of Statistics 7:1).
pub fn ratio(pairs: &[(f64, f64)]) -> Estimate {
    let of = |(above, below): (f64, f64)| above / below;
    let sum = |it: &mut dyn Iterator<Item = (f64, f64)>| it.fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (above, below) = sum(&mut pairs.iter().copied());
    let value = of((above, below));
    if pairs.is_empty() || below == 0.0 {
        return Estimate {
            value: f64::NAN,
            low: f64::NAN,
            high: f64::NAN,
        };
    }
    if above == 0.0 {
        return Estimate {
            value: 0.0,
            low: 0.0,
            high: 3.0 / below,
        };
    }
    let mut random = Random::new(SEED);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut drawn = (0..pairs.len()).map(|_| pairs[random.between(0.0, pairs.len() as f64) as usize]);
            of(sum(&mut drawn))
        })
        .filter(|mean| mean.is_finite())
        .collect();
    means.sort_by(f64::total_cmp);
    let at = |share: f64| means[((means.len() - 1) as f64 * share).round() as usize];
    Estimate {
        value,
        low: at(0.025),
        high: at(0.975),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_holds_the_mean_and_narrows() {
        let mut random = Random::new(7);
        let draw = |n: usize, random: &mut Random| -> Vec<(f64, f64)> {
            (0..n).map(|_| (random.between(0.0, 2.0), 1.0)).collect()
        };
        let (few, many) = (ratio(&draw(10, &mut random)), ratio(&draw(1000, &mut random)));
        assert!(few.low < 1.0 && 1.0 < few.high, "{few:?}");
        assert!(many.low < 1.0 && 1.0 < many.high, "{many:?}");
        assert!(
            many.high - many.low < (few.high - few.low) / 3.0,
            "{few:?} {many:?}"
        );
    }

    #[test]
    fn what_never_happened_is_not_called_impossible() {
        let never = ratio(&[(0.0, 1.0); 30]);
        assert_eq!((never.value, never.low, never.high), (0.0, 0.0, 0.1));
        assert!(ratio(&[(0.0, 0.0)]).value.is_nan());
    }
}
