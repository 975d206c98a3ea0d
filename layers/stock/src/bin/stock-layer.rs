//! Runs any manifest that is made of stock modules alone as a layer process: a layer without a line of Rust.

use std::process::ExitCode;

use ipc::wiring::Source;

const HELP: &str = "\
Runs a manifest that is made of stock modules alone as a layer of a running creature.

Usage: stock-layer MANIFEST.toml [OPTIONS]

Options: those of every layer process; `stock-layer MANIFEST.toml --help` lists them.

Example: stock-layer layers/stock/creatures/mux/joystick.toml
         `subsumectl check --in mux.toml joystick.toml` checks a manifest without running it.

Status: 0 after a signal, 1 when refused or the daemon is gone, 2 for bad input.";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let path = match arguments.next() {
        Some(first) if first == "--help" || first == "-h" => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        Some(path) if !path.starts_with('-') => path,
        other => {
            let got = other.map_or("nothing".into(), |o| format!("{o:?}"));
            eprintln!("stock-layer: expected the path of a manifest first, got {got}\n\n{HELP}");
            return ExitCode::from(2);
        }
    };
    match std::fs::read_to_string(&path) {
        Ok(text) => afsm::process::run_with(Source::of_file(path.as_ref(), text), stock::kinds(), arguments),
        Err(e) => {
            eprintln!("stock-layer: {path}: {e}; expected a manifest of a layer");
            ExitCode::from(2)
        }
    }
}
