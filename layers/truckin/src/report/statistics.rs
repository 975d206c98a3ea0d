//! Means, spreads and confidence intervals of whole numbers.

use std::collections::BTreeMap;

/// Two-sided 95 % of the normal distribution; samples here are in the hundreds and more.
const NORMAL_95: f64 = 1.959_963_985;

/// A mean and how sure it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// How many numbers.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation.
    pub deviation: f64,
}

impl Mean {
    /// Of some whole numbers.
    pub fn of(numbers: impl IntoIterator<Item = i64>) -> Self {
        // Welford's method: one pass, no difference of large squares.
        let (mut count, mut mean, mut squares) = (0_usize, 0.0, 0.0);
        for number in numbers {
            count += 1;
            let off = number as f64 - mean;
            mean += off / count as f64;
            squares += off * (number as f64 - mean);
        }
        let deviation = if count > 1 {
            (squares / (count - 1) as f64).sqrt()
        } else {
            0.0
        };
        Self {
            count,
            mean,
            deviation,
        }
    }

    /// Of numbers that come in clusters, such as trucks that met in one game: the deviation is that
    /// which would give the uncertainty the clusters show, each taken as one observation.
    pub fn of_clusters(numbers: impl Iterator<Item = (u32, i64)> + Clone) -> Self {
        let plain = Self::of(numbers.clone().map(|(_, number)| number));
        let mut off: BTreeMap<u32, f64> = BTreeMap::new();
        for (cluster, number) in numbers {
            *off.entry(cluster).or_default() += number as f64 - plain.mean;
        }
        if off.len() < 2 {
            return plain;
        }
        let (count, clusters) = (plain.count as f64, off.len() as f64);
        let squares: f64 = off.values().map(|off| off * off).sum();
        Self {
            deviation: (squares * clusters / (clusters - 1.0) / count).sqrt(),
            ..plain
        }
    }

    /// Half the width of the 95 % confidence interval of the mean.
    pub fn half_width(&self) -> f64 {
        if self.count == 0 {
            0.0
        } else {
            NORMAL_95 * self.deviation / (self.count as f64).sqrt()
        }
    }

    /// Whether the interval lies above 0.
    pub fn is_above_zero(&self) -> bool {
        self.mean - self.half_width() > 0.0
    }

    /// Whether the interval lies below 0.
    pub fn is_below_zero(&self) -> bool {
        self.mean + self.half_width() < 0.0
    }
}

/// The number below which so many hundredths of a sorted list lie.
pub fn hundredth(sorted: &[i64], hundredths: usize) -> i64 {
    if sorted.is_empty() {
        0
    } else {
        sorted[(sorted.len() - 1) * hundredths / 100]
    }
}

/// Cents as dollars.
pub fn dollars(cents: f64) -> String {
    let whole = (cents / 100.0).round() as i64;
    let digits = whole.unsigned_abs().to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    format!("{}${grouped}", if whole < 0 { "-" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::{Mean, dollars, hundredth};

    #[test]
    fn mean_and_interval() {
        let mean = Mean::of([2, 4, 4, 4, 5, 5, 7, 9]);
        assert_eq!(mean.mean, 5.0);
        assert!((mean.deviation - (32.0_f64 / 7.0).sqrt()).abs() < 1e-12);
        assert!(mean.is_above_zero() && !mean.is_below_zero());
    }

    #[test]
    fn clusters_of_one_are_no_clusters_and_copies_add_nothing() {
        let numbers = [2, 4, 4, 4, 5, 5, 7, 9];
        let alone = Mean::of_clusters(
            numbers
                .iter()
                .enumerate()
                .map(|(at, number)| (at as u32, *number)),
        );
        let plain = Mean::of(numbers);
        assert!((alone.half_width() - plain.half_width()).abs() < 1e-12);
        let copies = (0..5).flat_map(|_| numbers.iter().enumerate());
        let copied = Mean::of_clusters(copies.map(|(at, number)| (at as u32, *number)));
        assert!((copied.half_width() - plain.half_width()).abs() < 1e-12);
    }

    #[test]
    fn money_in_words() {
        assert_eq!(dollars(123_456_789.0), "$1,234,568");
        assert_eq!(dollars(-49_900.0), "-$499");
        assert_eq!((hundredth(&[1, 2, 3], 50), hundredth(&[], 50)), (2, 0));
    }
}
