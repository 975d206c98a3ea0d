//! `truckin evolve`: generations of trucks, the trial of the evolved one, and the report.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::inputs::{self, Trouble, at_least_one, say, stop_on_signals, threads};
use crate::arena::{TruckArena, chromosome_of};
use crate::evolve::{Breeding, Evolution, Generation, Genome};
use crate::grid::read_results;
use crate::ootland::Chance;
use crate::ootland::rules::TRUCKS_MAX;
use crate::report::evolution::Trial;
use crate::report::statistics::{Mean, dollars};
use crate::report::{self, Page};
use crate::strategies::Chromosome;

/// Evolves trucks.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  truckin evolve
  truckin evolve --generations 40 --trucks 20 --slots 5000 --grid truckin-grid.csv
  truckin evolve --generations 5 --games 4 --trial-games 20 --report quick.html")]
pub struct EvolveArgs {
    /// Generations.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    generations: u32,
    /// Trucks in a generation.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(5..=10_000))]
    population: u16,
    /// Games each truck plays in a generation.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    games: u32,
    /// Trucks in a game.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=TRUCKS_MAX as i64))]
    trucks: u32,
    /// Slots in a game.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    slots: u32,
    /// Games of the trial, in which every truck there is takes part.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    trial_games: u32,
    /// What everything is drawn from.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; the results do not depend on it. Without it, one for each core.
    #[arg(long, value_parser = at_least_one)]
    threads: Option<usize>,
    /// The world, as a TOML file; without it, the usual one.
    #[arg(long)]
    world: Option<PathBuf>,
    /// Results of the grid, to put into the report as well.
    #[arg(long)]
    grid: Option<PathBuf>,
    /// The report.
    #[arg(long, default_value = "truckin-evolve.html")]
    report: PathBuf,
}

pub(super) fn run(args: &EvolveArgs) -> Result<(), Trouble> {
    let world = inputs::world(args.world.as_deref())?;
    if let Some(grid) = &args.grid {
        inputs::apart(&args.report, grid)?;
    }
    let grid = args.grid.as_deref().map(read_results).transpose()?;
    let threads = threads(args.threads);
    let arena = TruckArena::new(
        world,
        args.trucks as usize,
        args.slots,
        args.games,
        args.seed,
        threads,
    );
    let breeding = Breeding::of(usize::from(args.population));
    let mut evolution = Evolution::new(&arena, breeding, Chance::new(args.seed, u64::MAX));
    let mut generations = Vec::new();
    let stop = stop_on_signals();
    // Relaxed: the flag guards nothing but itself.
    let stopped = || stop.load(Ordering::Relaxed);
    while generations.len() < args.generations as usize && !stopped() {
        let generation = evolution.next_generation();
        say(&line(&generation, args.games))?;
        generations.push(generation);
    }
    if generations.is_empty() {
        return Err(Trouble::Stopped("stopped before the first generation".to_owned()));
    }
    let evolved = champion(&generations);
    say(&format!("evolved: {evolved}"))?;
    let bar = ProgressBar::new(u64::from(args.trial_games));
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} % of the trial  {eta_precise} left");
    bar.set_style(style.expect("a template that was tried"));
    let profits = arena.trial(args.trial_games, &|games| bar.inc(games), &stop);
    bar.finish_and_clear();
    let tried = profits.first().map_or(0, Vec::len);
    // A mean has a deviation from two games on.
    let trial = (tried >= 2).then(|| Trial::new(evolved, &profits));
    if let Some(trial) = &trial {
        say(&trial.summary())?;
    }
    let mut page = Page::new("Truckin': evolution");
    page.paragraph(&format!(
        "{} generations of {} trucks, each in {} games of {} trucks and {} slots, seed {}.",
        generations.len(),
        args.population,
        args.games,
        args.trucks,
        args.slots,
        args.seed
    ));
    let kept = format!(
        "{} of {} generations, {tried} of {} games of the trial",
        generations.len(),
        args.generations,
        args.trial_games
    );
    let cut = generations.len() < args.generations as usize || tried < args.trial_games as usize;
    if cut {
        page.paragraph(&format!("It was stopped after {kept}."));
    }
    report::evolution::add_to(&mut page, &generations, args.games);
    if let Some(trial) = &trial {
        report::evolution::add_trial(&mut page, trial);
    }
    if let Some(grid) = grid {
        report::experiment::add_to(&mut page, &grid.rows);
    }
    let path = &args.report;
    page.write(path)
        .map_err(|error| Trouble::Failed(format!("{}: {error}", path.display())))?;
    if cut {
        return Err(Trouble::Stopped(format!(
            "{}: stopped; the report is of {kept}. The same command begins anew",
            path.display()
        )));
    }
    say(&format!("{}: the report", path.display()))
}

fn line(generation: &Generation, games: u32) -> String {
    let games = f64::from(games);
    let mean = Mean::of(generation.ranked.iter().map(|(_, fitness)| *fitness));
    let (best, fitness) = &generation.ranked[0];
    format!(
        "generation {:>3}: mean {:>8} a game, spread {:>8}, best {best} {}",
        generation.number,
        dollars(mean.mean / games),
        dollars(mean.deviation / games),
        dollars(*fitness as f64 / games)
    )
}

/// The truck evolution arrived at: of those in the last generation's mating pool, the one that has been
/// ahead of the mean of its generations by most, all generations together. One lucky generation does not
/// outweigh many good ones.
fn champion(generations: &[Generation]) -> Chromosome {
    let mut ahead: BTreeMap<&Genome, i64> = BTreeMap::new();
    for generation in generations {
        let members = generation.ranked.len() as i64;
        let mean = generation.ranked.iter().map(|(_, fitness)| fitness).sum::<i64>() / members;
        let mut counted: Vec<&Genome> = Vec::new();
        for (genome, fitness) in &generation.ranked {
            // Of copies in one generation only the best counts: many copies are no more evidence.
            if !counted.contains(&genome) {
                counted.push(genome);
                *ahead.entry(genome).or_default() += fitness - mean;
            }
        }
    }
    let last = generations.last().expect("at least one generation");
    let pool = Breeding::of(last.ranked.len()).parents();
    let best = last.ranked[..pool].iter().max_by_key(|(genome, _)| ahead[genome]);
    chromosome_of(&best.expect("a mating pool of at least one").0)
}

#[cfg(test)]
mod tests {
    use super::{Generation, Genome, champion};

    #[test]
    fn one_lucky_generation_does_not_outweigh_many_good_ones() {
        let genome = |text: &str| Genome::new(&text.bytes().map(|digit| digit - b'0').collect::<Vec<_>>());
        let mut generations: Vec<Generation> = (0..5)
            .map(|number| Generation {
                number,
                ranked: vec![(genome("4331"), 90), (genome("0000"), 10)],
            })
            .collect();
        let ranked = vec![(genome("2333"), 150), (genome("4331"), 80), (genome("0000"), 10)];
        generations.push(Generation {
            number: 5,
            ranked: [ranked.clone(), ranked].concat(),
        });
        generations[5].ranked.sort_by_key(|(_, fitness)| -fitness);
        generations[5].ranked.swap(1, 2);
        assert_eq!(champion(&generations).to_string(), "4331");
    }
}
