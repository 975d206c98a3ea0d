//! The percentile distribution: the text that HdrHistogram's plotters read (`.hgrm`), in microseconds.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use hdrhistogram::Histogram;

/// Lines for each halving of the distance to 100 %.
const TICKS: u32 = 5;

/// Writes the distribution of `h`, which is in nanoseconds.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, h: &Histogram<u64>) -> io::Result<()> {
    std::fs::write(path, text(h))
}

/// The distribution of `h` as text.
pub fn text(h: &Histogram<u64>) -> String {
    let mut out = String::from("       Value     Percentile TotalCount 1/(1-Percentile)\n\n");
    let mut sum = 0;
    for step in h.iter_quantiles(TICKS) {
        sum += step.count_since_last_iteration();
        let value = step.value_iterated_to() as f64 / 1e3;
        let quantile = step.quantile_iterated_to();
        let _ = write!(out, "{value:12.3} {quantile:2.12} {sum:10}");
        if quantile < 1.0 {
            let _ = write!(out, " {:14.2}", 1.0 / (1.0 - quantile));
        }
        out.push('\n');
    }
    let (buckets, sub) = (h.buckets(), h.distinct_values());
    let us = |ns: f64| ns / 1e3;
    let _ = writeln!(
        out,
        "#[Mean    = {:12.3}, StdDeviation   = {:12.3}]",
        us(h.mean()),
        us(h.stdev())
    );
    let _ = writeln!(
        out,
        "#[Max     = {:12.3}, Total count    = {:12}]",
        us(h.max() as f64),
        h.len()
    );
    let _ = writeln!(out, "#[Buckets = {buckets:12}, SubBuckets     = {sub:12}]");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distribution_goes_up_to_the_last_sample() {
        let mut h = crate::track::histogram();
        (1..=1000).for_each(|n| h.saturating_record(n * 1_000));
        let text = text(&h);
        let rows: Vec<Vec<f64>> = text
            .lines()
            .filter(|l| !l.starts_with('#'))
            .map(|l| l.split_whitespace().filter_map(|w| w.parse().ok()).collect())
            .filter(|row: &Vec<f64>| row.len() >= 3)
            .collect();
        assert!(rows.windows(2).all(|w| w[0][0] <= w[1][0] && w[0][1] <= w[1][1]));
        let last = rows.last().unwrap();
        assert_eq!((last[1], last[2]), (1.0, 1000.0));
        let median = rows.iter().find(|r| r[1] >= 0.5).unwrap();
        assert!((median[0] - 500.0).abs() < 2.0, "{median:?}");
    }
}
