//! `truckin world`: one to begin from, and is this one?

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

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
    /// Write the usual world, commented, to begin from; a file that is there already is left alone.
    #[command(after_help = "Example:\n  truckin world new desert.toml")]
    New {
        /// The file.
        file: PathBuf,
    },
    /// Check a world file; every fault comes with its line and column.
    #[command(after_help = "Example:\n  truckin world check desert.toml")]
    Check {
        /// The file.
        file: PathBuf,
    },
}

/// The usual world as a file.
const USUAL: &str = include_str!("../../templates/world.toml");

pub(super) fn run(args: &WorldArgs) -> Result<(), Trouble> {
    match &args.what {
        WorldWhat::New { file } => begin(file),
        WorldWhat::Check { file } => check(file),
    }
}

fn begin(file: &Path) -> Result<(), Trouble> {
    let name = file.display();
    let made = File::create_new(file).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            Trouble::BadInput(format!("{name} is there already; it is left as it is"))
        }
        _ => Trouble::BadInput(format!("{name}: {error}")),
    });
    let written = made?.write_all(USUAL.as_bytes());
    written.map_err(|error| Trouble::Failed(format!("{name}: {error}")))?;
    say(&format!(
        "{name}: the usual world; change it, and play in it with --world {name}"
    ))
}

fn check(file: &Path) -> Result<(), Trouble> {
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

#[cfg(test)]
mod tests {
    use super::USUAL;
    use crate::ootland::{World, world_file};

    #[test]
    fn the_world_to_begin_from_is_the_usual_one() {
        assert_eq!(world_file::read(USUAL), Ok(World::default()));
    }
}
