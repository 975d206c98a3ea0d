//! `truckin grid`: the whole experiment, resumable, and its report.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::inputs::{self, Trouble, at_least_one, say, stop_on_signals, threads};
use crate::grid::experiment::GAMES_MAX;
use crate::grid::{Experiment, Progress, read_results, run as play};
use crate::ootland::rules::{SLOTS_MAX, TRUCKS_MAX};
use crate::report::{self, Page};

/// Plays the whole experiment.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  truckin grid                                  the whole grid, into truckin-grid.csv
  truckin grid                                  again: goes on where it was stopped, by Ctrl-C or otherwise
  truckin grid --games 20 --trucks 1,5 --slots 1000 --out small.csv
  truckin grid --out small.csv --report small.html --check")]
pub struct GridArgs {
    /// The results, as CSV. A file that is there already is gone on with.
    #[arg(long, default_value = "truckin-grid.csv")]
    out: PathBuf,
    /// The report; without it, beside the results with the ending .html.
    #[arg(long)]
    report: Option<PathBuf>,
    /// What everything is drawn from.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Games of each cell.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=i64::from(GAMES_MAX)))]
    games: u32,
    /// Numbers of trucks.
    #[arg(long, value_delimiter = ',', default_values_t = Experiment::TRUCKS,
          value_parser = clap::value_parser!(u32).range(1..=TRUCKS_MAX as i64))]
    trucks: Vec<u32>,
    /// Lengths of games, in slots.
    #[arg(long, value_delimiter = ',', default_values_t = Experiment::SLOTS,
          value_parser = clap::value_parser!(u32).range(1..=i64::from(SLOTS_MAX)))]
    slots: Vec<u32>,
    /// Threads; the results do not depend on it. Without it, one for each core.
    #[arg(long, value_parser = at_least_one)]
    threads: Option<usize>,
    /// The world, as a TOML file; without it, the usual one.
    #[arg(long)]
    world: Option<PathBuf>,
    /// Check conservation and limits after every slot.
    #[arg(long)]
    check: bool,
}

pub(super) fn run(args: &GridArgs) -> Result<(), Trouble> {
    let world = inputs::world(args.world.as_deref())?;
    let path = args
        .report
        .clone()
        .unwrap_or_else(|| args.out.with_extension("html"));
    inputs::apart(&path, &args.out)?;
    let distinct = |list: &[u32]| (1..list.len()).all(|at| !list[..at].contains(&list[at]));
    if !distinct(&args.trucks) || !distinct(&args.slots) {
        return Err(Trouble::BadInput(
            "--trucks and --slots: each number once".to_owned(),
        ));
    }
    let mut experiment = Experiment::new(args.seed, args.games, &args.trucks, &args.slots, world);
    experiment.check = args.check;
    let threads = threads(args.threads);
    let bar = ProgressBar::new(experiment.truck_slots(experiment.blocks()));
    let style = ProgressStyle::with_template(
        "{bar:30} {percent:>3} %  {human_pos} of {human_len} truck-slots  {per_sec}  {eta_precise} left",
    );
    bar.set_style(style.expect("a template that was tried"));
    let stop = stop_on_signals();
    let begun = Instant::now();
    let mut first: Option<Progress> = None;
    let mut last = Progress {
        blocks: 0,
        truck_slots: 0,
    };
    play(&experiment, &args.out, threads, &mut |progress| {
        if first.is_none() {
            bar.set_position(progress.truck_slots);
            bar.reset_eta();
        }
        first.get_or_insert(progress);
        last = progress;
        bar.set_position(progress.truck_slots);
        // Relaxed: the flag guards nothing but itself.
        match stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    })?;
    bar.finish_and_clear();
    let (out, all) = (args.out.display(), experiment.truck_slots(experiment.blocks()));
    if last.blocks < experiment.blocks() {
        return Err(Trouble::Stopped(format!(
            "{out}: stopped; {} of {all} truck-slots are kept, and the same command goes on with them",
            last.truck_slots
        )));
    }
    let seconds = begun.elapsed().as_secs_f64();
    let played = last.truck_slots - first.map_or(0, |first| first.truck_slots);
    say(&format!(
        "{out}: {} truck-slots, {played} of them now, in {seconds:.1} s on {threads} threads: {:.2} million a \
         second and thread",
        last.truck_slots,
        played as f64 / seconds / threads as f64 / 1e6,
    ))?;
    let results = read_results(&args.out)?;
    let mut page = Page::new("Truckin': the grid");
    page.paragraph(results.settings.trim_start_matches('#'));
    report::experiment::add_to(&mut page, &results.rows);
    let path = args
        .report
        .clone()
        .unwrap_or_else(|| args.out.with_extension("html"));
    page.write(&path)
        .map_err(|error| Trouble::Failed(format!("{}: {error}", path.display())))?;
    say(&format!("{}: the report", path.display()))
}
