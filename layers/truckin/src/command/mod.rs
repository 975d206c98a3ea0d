//! The `truckin` command: one file for each subcommand.
//!
//! Exit status: 0 done, 1 failed, 2 bad input. Nothing that is bad input is ever written to.

mod evolve;
mod game;
mod grid;
mod inputs;
mod strategies;
mod world;

use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

pub use inputs::Trouble;

const EXAMPLES: &str = "Examples:
  truckin strategies                        what the digits of a chromosome stand for
  truckin game 4331 2322 --slots 300        watch one game
  truckin grid                              the whole experiment; again, to go on after a stop
  truckin evolve --grid truckin-grid.csv    evolve trucks and report
  truckin world check desert.toml           faults with line and column

Exit status: 0 done, 1 failed, 2 bad input.";

/// The command line of the `truckin` binary.
#[derive(Debug, Parser)]
#[command(
    name = "truckin",
    version,
    about = "Truckin': layers in two phases, and trucks that evolve",
    after_help = EXAMPLES
)]
pub struct CommandLine {
    /// What to do.
    #[command(flatten)]
    pub args: TruckinArgs,
}

/// The arguments, for whoever offers this command as one of theirs.
#[derive(Debug, Args)]
pub struct TruckinArgs {
    /// What to do.
    #[command(subcommand)]
    pub what: What,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum What {
    /// Play the whole experiment: every number of trucks by every length of game.
    Grid(grid::GridArgs),
    /// Evolve trucks and put the evolved one to the test against all there are.
    Evolve(evolve::EvolveArgs),
    /// Play one game and show it slot by slot.
    Game(game::GameArgs),
    /// Work with world files.
    World(world::WorldArgs),
    /// List the slots and their micro-strategies.
    Strategies(strategies::StrategiesArgs),
}

/// Does what the arguments say; complaints go to standard error.
pub fn command(args: TruckinArgs) -> ExitCode {
    let done = match args.what {
        What::Grid(args) => grid::run(&args),
        What::Evolve(args) => evolve::run(&args),
        What::Game(args) => game::run(&args),
        What::World(args) => world::run(&args),
        What::Strategies(args) => strategies::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(trouble) => {
            eprintln!("{trouble}");
            ExitCode::from(trouble.status())
        }
    }
}
