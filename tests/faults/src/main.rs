//! `faults`: breaks real daemons, bodies and layer processes, and measures what comes of it.

mod callers;
mod causes;
mod draws;
mod host;
mod inside;
mod kept;
mod layers;
mod lives;
mod observe;
mod outcome;
mod programs;
mod rogue;
mod soak;
mod stepped;
mod suite;
mod table;
mod trial;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use causes::{CAUSES, Cause};
use kept::Kept;
use programs::Programs;
use table::{Row, Table};
use trial::Trial;

#[global_allocator]
static ALLOCATOR: daemon::alloc::Counting = daemon::alloc::Counting;

/// Injects faults into real processes: does the body halt when it must, how soon, and does the rest go on?
#[derive(Parser, Debug)]
#[command(
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  \
    faults                              every cause a few times, in less than two minutes\n  \
    faults --cause daemon-kill          one cause\n  \
    faults --seeds 40 --rounds 25 --keep runs.jsonl --markdown\n  \
                                        the long run, 1,000 injections a cause, hours; stopped or killed, it goes on where it was\n  \
    faults soak --minutes 60            what grows, and what breaks once in a thousand times\n\n\
    Status: 0 when all is as specified; 1 when a halt was missed or a bound broken; 2 for bad input."
)]
struct Options {
    /// Trials of each cause
    #[arg(long, default_value_t = 2, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    seeds: u64,
    /// Injections of a trial, one after the other on one stage: the same body, and the same daemon where it lives
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    rounds: u64,
    /// The first seed
    #[arg(long, default_value_t = 1, value_name = "N")]
    from: u64,
    /// Keep the outcome of every trial in this file, and go on where it ends
    #[arg(long, value_name = "FILE")]
    keep: Option<PathBuf>,
    /// Trials at once, each on a stage of its own: each other's load, so some times are longer. Of those
    /// that keep a core busy, one less than there are cores
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=16))]
    jobs: u8,
    /// Only these causes (see --list)
    #[arg(long, num_args = 1.., value_name = "NAME")]
    cause: Vec<String>,
    /// The names of all causes
    #[arg(long)]
    list: bool,
    /// The report as JSON, with every injection
    #[arg(long, conflicts_with = "markdown")]
    json: bool,
    /// The report as a Markdown table
    #[arg(long)]
    markdown: bool,
    #[command(subcommand)]
    part: Option<Part>,
}

/// The soak, and parts that this program plays when it started itself.
#[derive(Subcommand, Debug)]
enum Part {
    /// Allen for minutes, while layers come, go, die and flood: does anything grow, or break once in a thousand times?
    Soak(soak::Options),
    /// The soak itself, on the stage that the environment names
    #[command(hide = true)]
    SoakInside {
        #[arg(long)]
        seconds: f64,
        #[arg(long)]
        seed: u64,
    },
    /// One trial, on the stage that the environment names
    #[command(hide = true)]
    Inject {
        cause: String,
        #[arg(long)]
        seed: u64,
        #[arg(long)]
        rounds: u64,
    },
    /// A layer process that misbehaves
    #[command(hide = true)]
    Rogue {
        how: rogue::Behaviour,
        name: String,
        #[arg(long)]
        seconds: f64,
        #[arg(long)]
        seed: u64,
    },
    /// A daemon with a module that breaks
    #[command(hide = true)]
    Inside {
        how: inside::Break,
        #[arg(long)]
        seconds: f64,
    },
}

fn main() -> ExitCode {
    let options = Options::parse();
    let played = match &options.part {
        Some(Part::Inject { cause, seed, rounds }) => inject(cause, *seed, *rounds),
        Some(Part::Rogue {
            how,
            name,
            seconds,
            seed,
        }) => rogue::run(*how, name, *seconds, *seed),
        Some(Part::Inside { how, seconds }) => inside::run(*how, *seconds),
        Some(Part::SoakInside { seconds, seed }) => soak::inside(*seconds, *seed),
        Some(Part::Soak(options)) => match soak::run(options) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE,
            Err(message) => Err(message),
        },
        None => return run(&options),
    };
    match played {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("faults: {message}");
            ExitCode::FAILURE
        }
    }
}

/// One trial; its outcome on standard output, whatever it is.
fn inject(name: &str, seed: u64, rounds: u64) -> Result<(), String> {
    let cause = causes::find(name).ok_or_else(|| format!("no cause {name:?}"))?;
    let mut trial = Trial::new(seed, rounds)?;
    let tried = (cause.inject)(&mut trial);
    let mut outcome = std::mem::take(&mut trial.outcome);
    match tried {
        Ok(()) => outcome.judge(cause.expected),
        Err(trouble) => outcome.broken.push(trouble),
    }
    let line = serde_json::to_string(&outcome).map_err(|e| e.to_string())?;
    println!("{line}");
    Ok(())
}

/// The whole suite.
fn run(options: &Options) -> ExitCode {
    if options.list {
        for cause in CAUSES {
            println!("{:17} {}", cause.name, cause.about);
        }
        return ExitCode::SUCCESS;
    }
    let chosen = match chosen(&options.cause) {
        Ok(chosen) => chosen,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    let report = programs::build().and_then(|()| Programs::beside_us());
    match report.and_then(|programs| try_all(options, &programs, &chosen)) {
        Ok(table) => {
            match (options.json, options.markdown) {
                (true, _) => println!("{:#}", table.json()),
                (_, true) => print!("{}", table.markdown()),
                _ => print!("{}", table.text()),
            }
            ExitCode::from(u8::from(table.broken() > 0))
        }
        Err(message) => {
            eprintln!("faults: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The causes of these names; all for none.
fn chosen(names: &[String]) -> Result<Vec<&'static Cause>, String> {
    let unknown: Vec<&str> = names
        .iter()
        .map(String::as_str)
        .filter(|n| causes::find(n).is_none())
        .collect();
    if !unknown.is_empty() {
        let known: Vec<&str> = CAUSES.iter().map(|c| c.name).collect();
        return Err(format!(
            "--cause: {} unknown; expected one or more of: {}",
            unknown.join(", "),
            known.join(", ")
        ));
    }
    let all = CAUSES.iter();
    Ok(all
        .filter(|c| names.is_empty() || names.iter().any(|n| n == c.name))
        .collect())
}

/// What is not yet in the file is tried, and the table of all of it made.
fn try_all(options: &Options, programs: &Programs, chosen: &[&'static Cause]) -> Result<Table, String> {
    let mut kept = Kept::open(options.keep.as_deref())?;
    let seeds = options.from..options.from.saturating_add(options.seeds);
    // Seeds are gone through together: a run that is stopped early has tried every cause about as often.
    let wanted = seeds
        .flat_map(|seed| chosen.iter().map(move |&cause| (seed, cause)))
        .filter(|(seed, cause)| kept.outcome(cause.name, *seed).is_none())
        .collect();
    let plan = suite::Plan {
        rounds: options.rounds,
        jobs: options.jobs.into(),
    };
    suite::inject_all(programs, wanted, &plan, &mut kept)?;
    let rows = chosen.iter().map(|&cause| Row {
        cause,
        outcomes: kept
            .of(cause.name)
            .map(|(seed, outcome)| (seed, outcome.clone()))
            .collect(),
    });
    Ok(Table(rows.filter(|row| !row.outcomes.is_empty()).collect()))
}
