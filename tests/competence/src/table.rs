//! The competence table as text, Markdown and JSON.

use serde_json::{Value, json};

use crate::figures::COLUMNS;
use crate::goals;
use crate::measure::Measured;
use crate::statistics::{Estimate, ratio};

/// The estimate of every column for one row.
pub fn estimates(measured: &Measured) -> Vec<Estimate> {
    let of = |column: &crate::figures::Column| {
        let pairs: Vec<_> = measured.figures.iter().map(column.of).collect();
        ratio(&pairs)
    };
    COLUMNS.iter().map(of).collect()
}

/// An estimate as `value (low to high)`; a dash when there is none.
fn shown(estimate: &Estimate, decimals: usize) -> String {
    if !estimate.value.is_finite() {
        return "-".into();
    }
    let Estimate { value, low, high } = estimate;
    format!("{value:.decimals$} ({low:.decimals$}-{high:.decimals$})")
}

fn cells(measured: &[Measured]) -> Vec<Vec<String>> {
    let mut head = vec!["row".to_string(), "trials".into()];
    head.extend(COLUMNS.iter().map(|c| c.title.to_string()));
    let mut cells = vec![head];
    for it in measured {
        let mut line = vec![it.row.title.to_string(), it.figures.len().to_string()];
        let estimates = estimates(it);
        line.extend(estimates.iter().zip(COLUMNS).map(|(e, c)| shown(e, c.decimals)));
        cells.push(line);
    }
    cells
}

/// The table for a terminal: one block for each row, since twelve columns with intervals fit no screen.
pub fn text(measured: &[Measured]) -> String {
    let mut out = String::new();
    for it in measured {
        out += &format!(
            "{}  [{}; {} trials]\n",
            it.row.title,
            it.row.name,
            it.figures.len()
        );
        for (estimate, column) in estimates(it).iter().zip(COLUMNS) {
            if estimate.value.is_finite() {
                out += &format!(
                    "  {:<13} {:>24}\n",
                    column.title,
                    shown(estimate, column.decimals)
                );
            }
        }
        out += "\n";
    }
    out + &goals::text(measured)
}

/// The table as Markdown.
pub fn markdown(measured: &[Measured]) -> String {
    let mut out = String::new();
    for (i, line) in cells(measured).iter().enumerate() {
        out += &format!("| {} |\n", line.join(" | "));
        if i == 0 {
            out += &format!("|{}\n", " --- |".repeat(line.len()));
        }
    }
    out + "\n" + &goals::text(measured)
}

/// Every contact of a robot's own making, one a line, so that it can be looked at: every trial can be repeated.
pub fn contacts(measured: &[Measured]) -> String {
    let mut out = String::from("row seed robot time_s with m/s x y\n");
    for it in measured {
        for figures in &it.figures {
            for c in &figures.caused_with {
                let (row, seed) = (it.row.name, figures.seed);
                let (x, y) = c.at;
                out += &format!(
                    "{row} {seed} {} {:.2} {:?} {:.3} {x:.2} {y:.2}\n",
                    c.robot, c.time_s, c.other, c.approach_m_s
                );
            }
        }
    }
    out
}

/// Everything, single trials included, as JSON.
pub fn json(measured: &[Measured]) -> Value {
    let row = |it: &Measured| {
        let estimates = estimates(it);
        let columns: serde_json::Map<String, Value> = estimates
            .iter()
            .zip(COLUMNS)
            .map(|(e, c)| (c.title.to_string(), json!(e)))
            .collect();
        json!({ "row": it.row.name, "title": it.row.title, "columns": columns, "trials": it.figures })
    };
    let rows: Vec<Value> = measured.iter().map(row).collect();
    json!({ "rows": rows, "goals": goals::all(measured) })
}
