//! The table: one row for each cause, as text, Markdown or JSON.
//!
//! Must never leave out a cause that was asked for, nor round a broken bound away.

use ipc::clock::Span;
use serde_json::{Value, json};

use crate::causes::Cause;
use crate::outcome::{Expected, Outcome};

/// One row: a cause, and all its injections.
pub(crate) struct Row {
    /// The cause.
    pub(crate) cause: &'static Cause,
    /// What came of each trial, with its seed.
    pub(crate) outcomes: Vec<(u64, Outcome)>,
}

/// The rows of a report.
pub(crate) struct Table(pub(crate) Vec<Row>);

const HEADS: [&str; 9] = [
    "fault",
    "tried",
    "expected",
    "as specified",
    "min",
    "p50",
    "p99",
    "max",
    "bound (periods)",
];

impl Row {
    fn tried(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes
            .iter()
            .map(|(_, o)| o)
            .filter(|o| o.skipped.is_none())
    }

    /// How often the fault was injected.
    fn injections(&self) -> u64 {
        self.tried().map(|o| o.injections).sum()
    }

    /// Injections of which something was not as specified.
    fn broken(&self) -> u64 {
        self.tried().map(Outcome::not_as_specified).sum()
    }

    /// Times from fault to halt, in periods, shortest first.
    fn periods(&self) -> Vec<f64> {
        let of_one = |o: &Outcome| {
            let period = o.period;
            let halts = o.halts.clone().into_iter();
            halts.filter_map(move |halted| Some(ratio(halted, period?)))
        };
        let mut times: Vec<f64> = self.tried().flat_map(of_one).collect();
        times.sort_by(f64::total_cmp);
        times
    }

    fn bound(&self) -> Option<f64> {
        self.tried().find_map(|o| Some(ratio(o.bound?, o.period?)))
    }

    fn cells(&self) -> [String; 9] {
        let tried = self.injections();
        let times = self.periods();
        let at = |q: f64| quantile(&times, q).map_or("–".into(), |t| format!("{t:.1}"));
        let skipped = self.outcomes.iter().find_map(|(_, o)| o.skipped.clone());
        let kept = match skipped {
            Some(why) if tried == 0 => format!("skipped: {why}"),
            _ => format!("{} of {tried}", tried - self.broken()),
        };
        [
            format!("{}: {}", self.cause.name, self.cause.about),
            tried.to_string(),
            match self.cause.expected {
                Expected::Halt => "halt",
                Expected::GoesOn => "goes on",
            }
            .into(),
            kept,
            at(0.0),
            at(0.5),
            at(0.99),
            at(1.0),
            self.bound()
                .map_or("–".into(), |b| format!("{b:.1}: {}", self.cause.bound)),
        ]
    }

    fn json(&self) -> Value {
        let times = self.periods();
        let at = |q: f64| quantile(&times, q);
        let sum = |of: fn(&Outcome) -> u64| self.tried().map(of).sum::<u64>();
        let longest = |of: fn(&Outcome) -> Option<Span>| self.tried().filter_map(of).max();
        json!({
            "cause": self.cause.name, "about": self.cause.about, "expected": self.cause.expected,
            "tried": self.injections(), "broken": self.broken(),
            "halt_periods": { "min": at(0.0), "p50": at(0.5), "p99": at(0.99), "max": at(1.0) },
            "bound_periods": self.bound(), "bound": self.cause.bound,
            "contacts": sum(|o| o.contacts), "allocations": sum(|o| o.allocations),
            "host_halts": sum(|o| o.host_halts),
            "host_late_max_ms": longest(|o| Some(o.host_late)).map(Span::as_millis_f64),
            "restart_max_ms": longest(|o| o.restart).map(Span::as_millis_f64),
            "trials": self.outcomes.iter().map(|(seed, o)| json!({ "seed": seed, "outcome": o })).collect::<Vec<_>>(),
        })
    }
}

impl Table {
    /// How many injections were not as specified.
    pub(crate) fn broken(&self) -> u64 {
        self.0.iter().map(Row::broken).sum()
    }

    /// For a terminal.
    pub(crate) fn text(&self) -> String {
        let rows = self.rows();
        let width = |column: usize| rows.iter().map(|r| r[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..HEADS.len()).map(width).collect();
        let mut text = String::new();
        for row in &rows {
            let cells = row
                .iter()
                .zip(&widths)
                .map(|(cell, width)| format!("{cell:width$}"));
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            text.push('\n');
        }
        text + "\n" + &self.summary()
    }

    /// For a page.
    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        for (number, row) in self.rows().iter().enumerate() {
            text.push_str(&format!("| {} |\n", row.join(" | ")));
            if number == 0 {
                text.push_str(&format!("|{}\n", " --- |".repeat(HEADS.len())));
            }
        }
        text + "\n" + &self.summary()
    }

    /// For programs, with every trial.
    pub(crate) fn json(&self) -> Value {
        json!({ "broken": self.broken(), "causes": self.0.iter().map(Row::json).collect::<Vec<_>>() })
    }

    fn rows(&self) -> Vec<[String; 9]> {
        let heads = HEADS.map(String::from);
        std::iter::once(heads)
            .chain(self.0.iter().map(Row::cells))
            .collect()
    }

    /// What holds of all rows, in sentences; then what was not as specified.
    fn summary(&self) -> String {
        let all = || self.0.iter().flat_map(Row::tried);
        let sum = |of: fn(&Outcome) -> u64| all().map(of).sum::<u64>();
        let ms = |span: Option<Span>| span.map_or("none".into(), |s| format!("{:.0} ms", s.as_millis_f64()));
        let mut text = format!(
            "{} injections, {} not as specified, {} halts missed. Contacts caused by the robot: {}. \
             Allocations on real-time threads: {}. Longest from a start after a death to a free body: {}. \
             Longest lateness of the host: {}; halts for that alone: {}.\n",
            sum(|o| o.injections),
            self.broken(),
            sum(|o| o.missed),
            sum(|o| o.contacts),
            sum(|o| o.allocations),
            ms(all().filter_map(|o| o.restart).max()),
            ms(all().map(|o| o.host_late).max()),
            sum(|o| o.host_halts),
        );
        for row in &self.0 {
            for (seed, outcome) in &row.outcomes {
                for broken in &outcome.broken {
                    text.push_str(&format!("BROKEN {} --seed {seed}: {broken}\n", row.cause.name));
                }
            }
        }
        text
    }
}

fn ratio(span: Span, period: Span) -> f64 {
    span.seconds() / period.seconds()
}

/// The smallest of `sorted` that at least the share `q` does not exceed.
fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let place = (q * sorted.len() as f64).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::causes::CAUSES;

    #[test]
    fn a_broken_injection_is_counted_named_and_in_every_form() {
        let cause = CAUSES
            .iter()
            .find(|c| c.expected == Expected::Halt)
            .expect("some halt");
        let outcome = |ms: u64, broken: Vec<String>| Outcome {
            injections: 1,
            halts: vec![Span::millis(ms)],
            bound: Some(Span::millis(220)),
            period: Some(Span::millis(20)),
            broken,
            ..Outcome::default()
        };
        let outcomes = vec![
            (1, outcome(190, Vec::new())),
            (2, outcome(240, vec!["too late".into()])),
        ];
        let table = Table(vec![Row { cause, outcomes }]);
        assert_eq!(table.broken(), 1);
        assert!(table.text().contains("1 of 2") && table.text().contains("--seed 2: too late"));
        assert!(table.markdown().contains("| 9.5 | 9.5 | 12.0 | 12.0 | 11.0: "));
        assert_eq!(table.json()["causes"][0]["halt_periods"]["max"], 12.0);
    }

    #[test]
    fn quantiles_are_values_that_were_seen() {
        let sorted: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(quantile(&sorted, 0.0), Some(1.0));
        assert_eq!(quantile(&sorted, 0.5), Some(50.0));
        assert_eq!(quantile(&sorted, 0.99), Some(99.0));
        assert_eq!(quantile(&sorted, 1.0), Some(100.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
