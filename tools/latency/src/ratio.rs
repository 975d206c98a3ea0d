//! Ratios of paired rounds: their median, geometric mean and spread.
//!
//! Must never compare what was not measured at the same time on the same processor.

use serde::Serialize;

/// What the rounds of one comparison say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// The median of the rounds.
    pub median: f64,
    /// Their geometric mean.
    pub mean: f64,
    /// Their geometric standard deviation: the mean times or divided by this holds about two thirds of them.
    pub spread: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
    /// How many rounds.
    pub rounds: usize,
}

impl Ratio {
    /// Of rounds; `None` without any. Zeros and what is no number are left out.
    pub fn of(rounds: &[f64]) -> Option<Ratio> {
        let mut sound: Vec<f64> = rounds
            .iter()
            .copied()
            .filter(|r| r.is_finite() && *r > 0.0)
            .collect();
        sound.sort_by(f64::total_cmp);
        let n = sound.len();
        let (first, last) = (*sound.first()?, *sound.last()?);
        let logs: Vec<f64> = sound.iter().map(|r| r.ln()).collect();
        let mean = logs.iter().sum::<f64>() / n as f64;
        let spread = if n < 2 {
            0.0
        } else {
            (logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1) as f64).sqrt()
        };
        Some(Ratio {
            median: 0.5 * (sound[(n - 1) / 2] + sound[n / 2]),
            mean: mean.exp(),
            spread: spread.exp(),
            min: first,
            max: last,
            rounds: n,
        })
    }
}

impl Ratio {
    /// What the true geometric mean is at least, with 95 % confidence (Student's t on the logarithms of the rounds).
    pub fn at_least(&self) -> f64 {
        let Some(freedom) = self.rounds.checked_sub(2) else {
            return self.mean;
        };
        let t = T_95.get(freedom).copied().unwrap_or(1.65);
        self.mean / self.spread.powf(t / (self.rounds as f64).sqrt())
    }
}

/// Student's t for 95 %, one-sided, at 1, 2, ... degrees of freedom; with more it comes near 1.65.
const T_95: [f64; 20] = [
    6.31, 2.92, 2.35, 2.13, 2.02, 1.94, 1.89, 1.86, 1.83, 1.81, 1.80, 1.78, 1.77, 1.76, 1.75, 1.75, 1.74,
    1.73, 1.73, 1.72,
];

impl std::fmt::Display for Ratio {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.2} ({:.2}–{:.2}, ×{:.2})",
            self.median, self.min, self.max, self.spread
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_rounds_and_their_spread() {
        let ratio = Ratio::of(&[4.0, 1.0, 0.25, f64::NAN, 0.0]).unwrap();
        assert_eq!(
            (ratio.median, ratio.min, ratio.max, ratio.rounds),
            (1.0, 0.25, 4.0, 3)
        );
        assert!((ratio.mean - 1.0).abs() < 1e-12 && (ratio.spread - 4.0).abs() < 1e-12);
        assert_eq!(Ratio::of(&[2.0, 3.0]).unwrap().median, 2.5);
        assert_eq!(Ratio::of(&[]), None);
    }

    #[test]
    fn what_is_sure_of_a_mean_grows_with_the_rounds() {
        let at_least = |rounds: &[f64]| Ratio::of(rounds).unwrap().at_least();
        assert!((at_least(&[3.0]) - 3.0).abs() < 1e-9);
        // Logarithms -ln 2, 0, ln 2: s.d. ln 2, t = 2.92.
        assert!((at_least(&[0.5, 1.0, 2.0]) - 2.0_f64.powf(-2.92 / 3.0_f64.sqrt())).abs() < 1e-9);
        let few = [2.0, 8.0].repeat(2);
        assert!(at_least(&few) < 2.0 && at_least(&few.repeat(6)) > 3.0);
        assert!(at_least(&[1.0; 40]) == 1.0);
    }
}
