//! `adroit figures`: nests in many seeded worlds, and what learning makes of chance.

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::figures::{Chance, Figures, Summary, chance, nests};

#[derive(Args, Clone, Debug)]
pub(super) struct FiguresArgs {
    /// How many worlds
    #[arg(long, default_value_t = 200)]
    worlds: usize,
    /// First seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Random co-occurrences the learner is shown
    #[arg(long, default_value_t = 10_000)]
    co_occurrences: u32,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct All {
    nests: Figures,
    learning: Chance,
}

pub(super) fn figures(args: &FiguresArgs) -> Result<(), String> {
    let style =
        ProgressStyle::with_template("{bar:40} {pos}/{len} worlds, {eta} left").map_err(|e| e.to_string())?;
    let bar = ProgressBar::new(args.worlds as u64).with_style(style);
    let nests = nests(args.seed, args.worlds, || bar.inc(1));
    bar.finish_and_clear();
    let learning = chance(args.co_occurrences, args.seed);
    let all = All { nests, learning };
    if args.json {
        println!(
            "{}",
            serde_json::to_string_pretty(&all).map_err(|error| error.to_string())?
        );
        return Ok(());
    }
    print_nests(&all.nests);
    print_learning(&all.learning);
    Ok(())
}

fn print_nests(figures: &Figures) {
    let row = |name: &str, of: &dyn Fn(&Summary) -> String| {
        println!(
            "{name:<28} {:>14} {:>14}",
            of(&figures.sequential),
            of(&figures.planned)
        );
    };
    println!("{:<28} {:>14} {:>14}", "", "sequential", "planned");
    row("nests complete", &|s| format!("{}/{}", s.complete, s.worlds));
    row("out of fuel", &|s| s.out_of_fuel.to_string());
    row("lowest fuel, tanks", &|s| format!("{:.3}", s.lowest_fuel));
    row("fuel used, tanks (mean)", &|s| format!("{:.3}", s.mean_tanks));
    row("path, m (mean)", &|s| format!("{:.2}", s.mean_path_m));
    row("time, s (mean)", &|s| format!("{:.1}", s.mean_time_s));
    row("path to bound (mean)", &|s| format!("{:.3}", s.path_to_bound));
    row("time to bound (mean)", &|s| format!("{:.3}", s.time_to_bound));
    row("worlds with a bump", &|s| s.bumped.to_string());
    row("evaluations", &|s| s.evaluations.to_string());
    row("incomplete seeds", &|s| format!("{:?}", s.incomplete_seeds));
    println!(
        "bound: {:.2} m, {:.1} s (straight lines, all known)",
        figures.bound_path_m, figures.bound_time_s
    );
    println!(
        "planned to sequential, worlds completed both ways: path {:.3}, time {:.3}",
        figures.planned_to_sequential_path, figures.planned_to_sequential_time
    );
}

fn print_learning(chance: &Chance) {
    println!(
        "learning by chance: {} co-occurrences in {} trials, {} proposed, {} applied",
        chance.co_occurrences, chance.trials, chance.proposed, chance.applied
    );
    println!(
        "learning a cue that belongs: proposed after {}, applied after {} experiences",
        chance.experiences_to_propose, chance.experiences_to_apply
    );
}
