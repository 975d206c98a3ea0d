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
}
