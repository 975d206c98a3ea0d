//! `truckin world check`: is this a world?

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::inputs::{self, Trouble, say};

/// Works with world files.
#[derive(Debug, Args)]
pub struct WorldArgs {
    #[command(subcommand)]
    what: WorldWhat,
}

#[derive(Debug, Subcommand)]
enum WorldWhat {
    /// Check a world file; every fault comes with its line and column.
    #[command(after_help = "Example:\n  truckin world check desert.toml")]
    Check {
        /// The file.
        file: PathBuf,
    },
}

pub(super) fn run(args: &WorldArgs) -> Result<(), Trouble> {
    let WorldWhat::Check { file } = &args.what;
    let world = inputs::world(Some(file))?;
    let scattered: u32 = world.scattered.iter().map(|(_, count)| u32::from(*count)).sum();
    let (avenues, streets) = (world.grid.avenues, world.grid.streets);
    let fixed = world.dealers.len();
    say(&format!(
        "{}: {avenues} avenues by {streets} streets, {fixed} dealers with a corner of their own, {scattered} \
         scattered",
        file.display()
    ))
}
