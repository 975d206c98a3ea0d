//! `instructions CASE TURNS`: does one case so many times, to be counted from outside (`tests/instructions.sh`).
//!
//! Must never do anything but the case between set-up and end: the count of N turns is taken from that of 2N.

use std::process::ExitCode;

use latency::cases::{CASES, find};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, turns] = &arguments[..] else {
        CASES
            .iter()
            .for_each(|case| println!("{}\t{}", case.name, case.about));
        return ExitCode::SUCCESS;
    };
    let (Some(case), Ok(turns)) = (find(name), turns.parse::<u64>()) else {
        eprintln!("expected a case (run without arguments for a list) and a number of turns");
        return ExitCode::from(2);
    };
    let mut turn = (case.ready)();
    (0..turns).for_each(|_| turn());
    ExitCode::SUCCESS
}
