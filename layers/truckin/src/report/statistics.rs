//! Means, spreads and confidence intervals of whole numbers.

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
