//! What was to be reached, and whether it was.
//!
//! Must never leave out a goal because it was missed.

use serde::Serialize;

use crate::figures::{Figures, column};
use crate::measure::Measured;
use crate::statistics::{Estimate, ratio};

/// A goal.
#[derive(Clone, Debug, Serialize)]
pub struct Goal {
    /// What was to be reached.
    pub what: String,
    /// What was found.
    pub found: String,
    /// Whether that is it.
    pub reached: bool,
}

fn estimate(measured: &Measured, title: &str) -> Estimate {
    let pairs: Vec<_> = measured.figures.iter().map(column(title).of).collect();
    ratio(&pairs)
}

/// Every goal that the rows at hand can tell of.
pub fn all(measured: &[Measured]) -> Vec<Goal> {
    let of = |name: &str| {
        measured
            .iter()
            .find(|m| m.row.name == name && !m.figures.is_empty())
    };
    let mut goals = Vec::new();
    for it in measured
        .iter()
        .filter(|m| m.row.dead == 0 && !m.figures.is_empty())
    {
        let caused: f64 = it.figures.iter().map(|f| f.caused).sum();
        let hours: f64 = it.figures.iter().map(|f| f.hours).sum();
        goals.push(Goal {
            what: format!("{}: no contact caused by the robot", it.row.title),
            found: format!("{caused} in {hours:.1} h"),
            reached: caused == 0.0,
        });
    }
    if let Some(quiet) = of("quiet") {
        let farthest = quiet.figures.iter().map(|f| f.drift_m).fold(0.0, f64::max);
        goals.push(Goal {
            what: "level 0 in an empty quiet room drifts less than half a metre".into(),
            found: format!("{farthest:.2} m at most"),
            reached: farthest < 0.5,
        });
    }
    if let (Some(low), Some(high)) = (of("0"), of("01")) {
        goals.push(times(
            low,
            high,
            "area m2",
            3.0,
            "0+1 covers three times the area of 0",
        ));
    }
    if let (Some(low), Some(high)) = (of("01"), of("012")) {
        goals.push(times(
            low,
            high,
            "rooms",
            2.0,
            "0+1+2 visits twice the rooms of 0+1",
        ));
        let share = estimate(high, "reached %");
        goals.push(Goal {
            what: "0+1+2 reaches 90 % of the places it sets out for".into(),
            found: format!("{:.1} % ({:.1}-{:.1})", share.value, share.low, share.high),
            reached: share.value >= 90.0,
        });
    }
    // A level 2 that is killed and started again lives half of the time, and takes the robot to where people
    // are: that is not the lower levels' doing. Killed for good it should leave them as they are alone.
    let pairs = [("nonsense", "0"), ("cut", "01"), ("killed", "01")];
    for (disturbed, alone) in pairs {
        if let (Some(disturbed), Some(alone)) = (of(disturbed), of(alone)) {
            goals.push(same(disturbed, alone, "caused/h"));
            goals.push(same(disturbed, alone, "contacts/h"));
        }
    }
    goals
}

fn times(low: &Measured, high: &Measured, title: &str, factor: f64, what: &str) -> Goal {
    let (a, b) = (estimate(low, title), estimate(high, title));
    Goal {
        what: what.into(),
        found: format!(
            "{:.2} times ({:.1} against {:.1})",
            b.value / a.value,
            b.value,
            a.value
        ),
        reached: b.value >= factor * a.value,
    }
}

/// Whether two rows agree in a column: their intervals meet, or those of the differences seed by seed hold
/// nought.
fn same(a: &Measured, b: &Measured, title: &str) -> Goal {
    let (x, y) = (estimate(a, title), estimate(b, title));
    let of = column(title).of;
    let by_seed = |f: &Figures| {
        let other = b.figures.iter().find(|o| o.seed == f.seed)?;
        Some((of(f).0 / of(f).1 - of(other).0 / of(other).1, 1.0))
    };
    let differences: Vec<_> = a.figures.iter().filter_map(by_seed).collect();
    let difference = ratio(&differences);
    let reached = x.meets(&y) || (difference.low <= 0.0 && difference.high >= 0.0);
    Goal {
        what: format!("{}: {title} as in {}", a.row.title, b.row.title),
        found: format!(
            "{:.2} ({:.2}-{:.2}) against {:.2} ({:.2}-{:.2})",
            x.value, x.low, x.high, y.value, y.low, y.high
        ),
        reached,
    }
}

/// The goals, one a line.
pub fn text(measured: &[Measured]) -> String {
    let goals = all(measured);
    if goals.is_empty() {
        return String::new();
    }
    let line = |goal: &Goal| {
        let mark = if goal.reached { "reached" } else { "MISSED " };
        format!("- {mark}  {}: {}\n", goal.what, goal.found)
    };
    format!("To reach:\n\n{}", goals.iter().map(line).collect::<String>())
}
