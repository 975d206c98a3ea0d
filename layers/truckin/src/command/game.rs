//! `truckin game`: one game, slot by slot.

use std::path::PathBuf;

use clap::Args;

use super::inputs::{self, Trouble, say};
use crate::ootland::rules::{SLOTS_MAX, TRUCKS_MAX};
use crate::ootland::view::TruckView;
use crate::ootland::{Game, GameView};
use crate::strategies::{Chromosome, ChromosomeFault};

/// Plays one game and shows it slot by slot.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  truckin game 0312 1023 --slots 200
  truckin game 4333 --slots 5000 --every 500
  truckin game 2322 2322 4331 --json --check > game.ndjson")]
pub struct GameArgs {
    /// The trucks, by their chromosomes.
    #[arg(required = true)]
    trucks: Vec<String>,
    /// Slots in the game.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=i64::from(SLOTS_MAX)))]
    slots: u32,
    /// What everything is drawn from.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Which of the games of the seed.
    #[arg(long, default_value_t = 0)]
    game: u64,
    /// The world, as a TOML file; without it, the usual one.
    #[arg(long)]
    world: Option<PathBuf>,
    /// Show every so manieth slot only, and the last.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// One JSON object a line: the map, dealers, trucks, plans, layers.
    #[arg(long)]
    json: bool,
    /// Check conservation and limits after every slot.
    #[arg(long)]
    check: bool,
}

pub(super) fn run(args: &GameArgs) -> Result<(), Trouble> {
    let world = inputs::world(args.world.as_deref())?;
    if args.trucks.len() > TRUCKS_MAX {
        return Err(Trouble::BadInput(format!(
            "{} trucks: at most {TRUCKS_MAX}",
            args.trucks.len()
        )));
    }
    let trucks = chromosomes(&args.trucks)?;
    let mut game = Game::new(&world, &trucks, args.slots, args.seed, args.game);
    while !game.is_over() {
        game.play_slot();
        if args.check {
            game.check().map_err(|fault| Trouble::Failed(fault.to_string()))?;
        }
        if game.clock().slot.is_multiple_of(args.every) || game.is_over() {
            show(&GameView::of(&game), args.json)?;
        }
    }
    Ok(())
}

/// Reads every chromosome; what is wrong with any of them is told in one go.
fn chromosomes(texts: &[String]) -> Result<Vec<Chromosome>, Trouble> {
    let (mut trucks, mut faults) = (Vec::new(), Vec::new());
    for text in texts {
        match text.parse() {
            Ok(truck) => trucks.push(truck),
            Err(fault) => faults.push(ChromosomeFault::to_string(&fault)),
        }
    }
    if faults.is_empty() {
        return Ok(trucks);
    }
    let advice = "`truckin strategies` tells what each digit stands for";
    Err(Trouble::BadInput(format!("{}\n{advice}", faults.join("\n"))))
}

fn show(view: &GameView, json: bool) -> Result<(), Trouble> {
    if json {
        let line = serde_json::to_string(view).map_err(|error| Trouble::Failed(error.to_string()))?;
        return say(&line);
    }
    view.trucks
        .iter()
        .try_for_each(|truck| say(&line(view.slot, truck)))
}

/// One truck in one line: slot, name, place, purse, tank, load, the layer that holds it and its plan.
fn line(slot: u32, truck: &TruckView) -> String {
    let held = match truck.holder {
        None => "waits".to_owned(),
        Some(rank) => {
            let layer = &truck.layers[usize::from(rank)];
            format!("{}: {}", layer.strategy, layer.plan.join(", "))
        }
    };
    let inhibited: Vec<&str> = truck
        .layers
        .iter()
        .filter(|layer| layer.inhibited)
        .map(|layer| layer.slot)
        .collect();
    let inhibited = if inhibited.is_empty() {
        String::new()
    } else {
        format!("  [inhibited: {}]", inhibited.join(", "))
    };
    format!(
        "{slot:>6} {} #{:<2} ({:>2},{:>2}) {:>10}.{:02} $ {:>3} l {:>4} crates {:>5} items  {held}{inhibited}",
        truck.chromosome,
        truck.seat,
        truck.avenue,
        truck.street,
        truck.capital_cents / 100,
        truck.capital_cents % 100,
        truck.tank_millilitres / 1000,
        truck.crates,
        truck.items,
    )
}
