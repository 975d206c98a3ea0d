//! The report of a soak: what happened, what was not as it should be, what grew.
//!
//! Must never leave out that a run was cut short, or too short to say whether anything grows.

use std::collections::BTreeMap;

use ipc::clock::Span;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::acts::Tally;
use super::growth::{Growth, JUDGED_MIN, Line};

/// The report.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Report {
    seed: u64,
    took: Span,
    asked: Span,
    acts: BTreeMap<String, u64>,
    halts_due: u64,
    halts_missed: u64,
    host_halts: u64,
    contacts_caused: u64,
    contacts_all: u64,
    allocations: u64,
    went_m: f64,
    growth: Vec<Line>,
    /// What is not as it should be.
    pub(super) broken: Vec<String>,
}

impl Report {
    /// Of a soak that is over.
    pub(super) fn new(seed: u64, took: Span, asked: Span, tally: Tally, growth: &Growth) -> Report {
        let mut broken = tally.broken;
        let growth = growth.lines();
        for line in growth.iter().filter(|line| line.grew()) {
            broken.push(format!("{} grew from {} to {}", line.what, line.early, line.late));
        }
        for (count, what) in [
            (tally.contacts, "contacts caused by the robot"),
            (tally.allocations, "allocations on real-time threads"),
        ] {
            if count > 0 {
                broken.push(format!("{count} {what}"));
            }
        }
        Report {
            seed,
            took,
            asked,
            acts: tally.done.into_iter().map(|(name, n)| (name.into(), n)).collect(),
            halts_due: tally.due,
            halts_missed: tally.missed,
            host_halts: tally.host_halts,
            contacts_caused: tally.contacts,
            contacts_all: tally.contacts_all,
            allocations: tally.allocations,
            went_m: tally.went_m,
            growth,
            broken,
        }
    }

    /// Takes in which files were left behind.
    pub(super) fn left_behind(&mut self, files: Vec<String>) {
        if !files.is_empty() {
            self.broken.push(format!("left behind: {files:?}"));
        }
    }

    /// For programs.
    pub(super) fn json(&self) -> Value {
        json!(self)
    }

    /// For a terminal, as a Markdown table.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("| what happened | times |\n| --- | --- |\n");
        for (name, times) in &self.acts {
            text.push_str(&format!("| {name} | {times} |\n"));
        }
        text.push_str("\n| held | early | late | most | may grow by |\n| --- | --- | --- | --- | --- |\n");
        for line in &self.growth {
            let Line {
                what,
                early,
                late,
                most,
                more_max,
                ..
            } = line;
            text.push_str(&format!("| {what} | {early} | {late} | {most} | {more_max} |\n"));
        }
        if self.growth.is_empty() {
            let least = JUDGED_MIN.seconds() / 60.0;
            text.push_str(&format!(
                "| nothing is said of less than {least} minutes | – | – | – | – |\n"
            ));
        }
        let minutes = |span: Span| span.seconds() / 60.0;
        let cut = match minutes(self.took) + 0.1 < minutes(self.asked) {
            true => format!(" of {:.1}, cut short", minutes(self.asked)),
            false => String::new(),
        };
        text.push_str(&format!(
            "\n{:.1} minutes{cut}, seed {}, {} acts. Halts that had to come: {}, missed: {}; halts for the host's \
             lateness alone: {}. Contacts caused by the robot: {} (of {} in all), which went {:.0} m at least. \
             Allocations on real-time threads: {}.\n",
            minutes(self.took),
            self.seed,
            self.acts.values().sum::<u64>(),
            self.halts_due,
            self.halts_missed,
            self.host_halts,
            self.contacts_caused,
            self.contacts_all,
            self.went_m,
            self.allocations,
        ));
        for broken in &self.broken {
            text.push_str(&format!("BROKEN {broken}\n"));
        }
        text
    }
}
