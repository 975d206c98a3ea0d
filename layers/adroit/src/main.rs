//! The `adroit` command: check, format, draw and run programs of releasing mechanisms.

use std::process::ExitCode;

use adroit::command::{AdroitArgs, command};
use clap::Parser;

#[derive(Parser)]
#[command(name = "adroit", version, about = "Releasing mechanisms after Friedman 1969")]
struct Cli {
    #[command(flatten)]
    args: AdroitArgs,
}

fn main() -> ExitCode {
    command(Cli::parse().args)
}
