//! Manual pages and completions, made from the very definitions that read the command lines.
//!
//! Must never describe an option by hand.

use std::path::Path;

use clap::{Command, CommandFactory, ValueEnum};
use clap_complete::Shell;

/// A program of the project.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Program {
    /// The tool
    Subsumectl,
    /// The daemon
    Subsumed,
    /// A body in a process of its own
    SubsumedBody,
}

impl Program {
    /// Its command line.
    pub(crate) fn command(self) -> Command {
        match self {
            Program::Subsumectl => crate::Options::command(),
            Program::Subsumed => daemon::options::Options::command(),
            Program::SubsumedBody => daemon::options::BodyOptions::command(),
        }
    }
}

/// Prints completions of `program` for `shell`.
pub(crate) fn completions(shell: Shell, program: Program) {
    let mut command = program.command();
    let name = command.get_name().to_string();
    clap_complete::generate(shell, &mut command, name, &mut std::io::stdout());
}

/// Writes a manual page for each program and command into `folder`.
pub(crate) fn pages(folder: &Path) -> Result<(), String> {
    let wrong = |e: std::io::Error| format!("{}: {e}", folder.display());
    std::fs::create_dir_all(folder).map_err(wrong)?;
    for program in Program::value_variants() {
        clap_mangen::generate_to(program.command(), folder).map_err(wrong)?;
    }
    Ok(())
}
