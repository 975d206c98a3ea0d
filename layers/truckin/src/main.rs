//! The `truckin` command.

use std::process::ExitCode;

use clap::Parser;
use truckin::command::{CommandLine, command};

fn main() -> ExitCode {
    command(CommandLine::parse().args)
}
