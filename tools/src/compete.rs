//! Competences: what a creature can do with how many of its levels, measured over many simulated hours.
//!
//! Must never speak to a running creature: trials have worlds and clocks of their own.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use competence::{Order, ROWS, Row, measure, plot, row, table, trial};
use indicatif::{ProgressBar, ProgressStyle};
use ipc::wiring::check;
use ipc::wiring::diagnostic::one_of;

/// What to measure, and where the results go.
#[derive(Args, Debug)]
pub(crate) struct Asked {
    /// The creature; allen is the only one so far
    creature: String,
    /// Rows of the table, separated by commas; all of them if not given
    #[arg(long, value_delimiter = ',', value_name = "ROW,...")]
    rows: Vec<String>,
    /// Trials of each row; each has a seed and an office of its own
    #[arg(long, default_value_t = 20, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    seeds: u64,
    /// Simulated hours of each trial
    #[arg(long, default_value_t = 1.0, value_name = "H")]
    hours: f64,
    /// Threads; all cores if not given
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// First seed: the trials have this one and those that follow
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    first: u64,
    /// A floor plan to measure in (see `subsumectl new layout`), instead of the generated office of each seed;
    /// rows of another world or with an empty room are not measured then
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// List every contact that a robot caused: row, seed, time, with what, how fast, where
    #[arg(long)]
    contacts: bool,
    /// Also write the table as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Also write the plot, an SVG
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Measures and prints. Ctrl-C ends it early and keeps what is done.
pub(crate) fn compete(asked: &Asked, as_json: bool) -> ExitCode {
    let order = match order(asked) {
        Ok(order) => order,
        Err(wrong) => {
            wrong.iter().for_each(|w| eprintln!("subsumectl: {w}"));
            return ExitCode::from(2);
        }
    };
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        // The second one ends the program at once.
        let _ = signal_hook::flag::register_conditional_default(signal, stop.clone());
        let _ = signal_hook::flag::register(signal, stop.clone());
    }
    let bar = ProgressBar::new(order.rows.len() as u64 * order.seeds);
    let style = "{elapsed_precise} [{bar:40}] {pos}/{len} trials, {eta} left";
    bar.set_style(ProgressStyle::with_template(style).expect("the template is one"));
    bar.tick();
    let measured = measure(&order, &stop, &|| bar.inc(1));
    bar.finish_and_clear();
    if as_json {
        println!("{}", table::json(&measured));
    } else {
        println!("{}", table::text(&measured));
        if asked.contacts {
            println!("{}", table::contacts(&measured));
        }
    }
    let files = [
        (&asked.markdown, table::markdown as fn(&_) -> String),
        (&asked.plot, plot::svg),
    ];
    let mut kept = true;
    for (path, text) in files {
        if let Some(path) = path {
            kept &= write(path, &text(&measured));
        }
    }
    if stop.load(Ordering::Relaxed) {
        eprintln!("stopped: these are the trials done so far");
    }
    if kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// What is wrong with measuring `rows` in the layout `file`.
fn layout_faults(file: &Path, rows: &[&'static Row]) -> Option<String> {
    let Some(row) = rows.first() else {
        return Some("--layout: none of the rows asked for is in an office".into());
    };
    let text = row.asked(1, Some(file));
    if let Err(rejected) = check::creature(&trial::source(&text), &trial::all_kinds()) {
        return Some(format!("--layout: {rejected}"));
    }
    let crowded = rows.iter().find(|row| !trial::has_room(row, &text));
    crowded.map(|row| {
        let name = row.name;
        format!("--layout: no place in it is far enough from the start for the second robot of row {name:?}")
    })
}

fn write(path: &Path, text: &str) -> bool {
    match std::fs::write(path, text) {
        Ok(()) => true,
        Err(e) => {
            eprintln!("subsumectl: {} cannot be written: {e}", path.display());
            false
        }
    }
}

/// What was asked for, or everything wrong with it.
fn order(asked: &Asked) -> Result<Order, Vec<String>> {
    let mut wrong = Vec::new();
    if asked.creature != "allen" {
        let help = one_of("creature", &asked.creature, ["allen"]);
        wrong.push(format!("no table is known for {:?}; {help}", asked.creature));
    }
    if !(0.01..=1000.0).contains(&asked.hours) {
        wrong.push(format!("--hours {}: expected 0.01 to 1000", asked.hours));
    }
    let mut rows: Vec<&'static Row> = Vec::new();
    for name in &asked.rows {
        match row::find(name) {
            Some(row) => rows.push(row),
            None => {
                let help = one_of("row", name, ROWS.iter().map(|r| r.name));
                wrong.push(format!("--rows: there is no row {name:?}; {help}"));
            }
        }
    }
    if asked.rows.is_empty() {
        rows = ROWS.iter().collect();
    }
    if let Some(file) = &asked.layout {
        rows.retain(|row| row.is_in_an_office());
        wrong.extend(layout_faults(file, &rows));
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if wrong.is_empty() {
        Ok(Order {
            rows,
            first: asked.first,
            seeds: asked.seeds,
            hours: asked.hours,
            layout: asked.layout.clone(),
            threads: asked.threads.unwrap_or(cores).clamp(1, 256),
        })
    } else {
        Err(wrong)
    }
}
