//! `subsumectl latency`: what is asked for on the command line, and what is answered.
//!
//! Must never end without saying what was measured: an interruption is noted, not an error.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::ValueEnum;
use ipc::clock::Span;
use serde_json::{Value, json};

use crate::compare::compare;
use crate::gate::{self, Compared, Verdict};
use crate::load::Load;
use crate::pair::Contest;
use crate::plant::Plant;
use crate::run::{Asked, Outcome, run};
use crate::{cyclictest, report};

/// The reference to measure against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Reference {
    /// cyclictest of Debian's package rt-tests: how late threads wake
    Cyclictest,
    /// A bare iceoryx2 blackboard, and a bare sequence lock: how long a message takes to another process
    Blackboard,
}

/// Arguments of `subsumectl latency`.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    subsumectl latency                                    half a minute, nothing else running\n  \
    subsumectl latency --load memory --seconds 60         beside a load on the same processor\n  \
    subsumectl latency --load churn                       with layers that come, go and are killed\n  \
    subsumectl latency --against cyclictest --rounds 10   in pairs with the reference\n  \
    subsumectl latency --seconds 0 --against blackboard   a message to another process, in turns with others\n\n\
    Files in --out: latency.hlog (HdrHistogram interval log, V2), *.hgrm, latency.svg, latency.json, latency.md.\n\
    Only one processor is loaded. Ctrl-C keeps what was measured. docs/timing.md says what each number means.\n\
    Status: 0 done; 1 the host refuses, or --gate does not pass; 2 bad input.")]
pub struct LatencyArgs {
    /// What else the processor has to do
    #[arg(long, value_enum, default_value = "idle")]
    load: Load,
    /// How long the lab's creature is measured; 0 to leave it out
    #[arg(long, default_value_t = 30.0, value_name = "N")]
    seconds: f64,
    /// Measure in pairs with this
    #[arg(long, value_enum)]
    against: Option<Reference>,
    /// Paired rounds of each contest
    #[arg(long, default_value_t = 10, value_name = "N")]
    rounds: usize,
    /// How long each is
    #[arg(long, default_value_t = 10.0, value_name = "N")]
    round_seconds: f64,
    /// Time between two beats
    #[arg(long, default_value = "1ms", value_name = "TIME", value_parser = Span::parse)]
    period: Span,
    /// The processor under test; the last one if not given
    #[arg(long, value_name = "N")]
    cpu: Option<usize>,
    /// SCHED_FIFO priority in paired rounds
    #[arg(long, default_value_t = 80, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=98))]
    priority: u8,
    /// How long is spun before a beat where it is
    #[arg(long, default_value = "50us", value_name = "TIME", value_parser = Span::parse)]
    spin: Span,
    /// The creature's threads spin before their beats as well
    #[arg(long)]
    spinning: bool,
    /// Folder for the files
    #[arg(long, default_value = "latency-report", value_name = "FOLDER")]
    out: PathBuf,
    /// End with status 1 unless the run is within the margins; adds rounds where it is in doubt
    #[arg(long)]
    gate: bool,
    /// A fault put into every step on purpose, to see the gate fail
    #[arg(long, value_enum, hide = true)]
    plant: Option<Plant>,
}

/// Longest run in one go, so that a slip of the keyboard does not measure for a year.
const SECONDS_MAX: f64 = 86_400.0;

/// Runs the command.
pub fn command(args: &LatencyArgs, json: bool) -> ExitCode {
    let asked = match ask(args) {
        Ok(asked) => asked,
        Err(message) => {
            eprintln!("subsumectl latency: {message}");
            return ExitCode::from(2);
        }
    };
    if args.against == Some(Reference::Cyclictest) && !cyclictest::available() {
        eprintln!(
            "subsumectl latency: cyclictest cannot be run; install it (Debian: apt-get install rt-tests)"
        );
        return ExitCode::FAILURE;
    }
    daemon::executor::host::limit_runaway();
    let locked = daemon::executor::host::lock_memory().err();
    let outcome = match run(&asked) {
        Ok(mut outcome) => {
            outcome.refusals.extend(locked.iter().map(ToString::to_string));
            outcome
        }
        Err(message) => {
            eprintln!("subsumectl latency: {message}");
            return ExitCode::FAILURE;
        }
    };
    answer(args, &asked, &outcome, json)
}

fn ask(args: &LatencyArgs) -> Result<Asked, String> {
    let cpus = daemon::executor::host::processors();
    let cpu = args.cpu.or(cpus.last().copied()).unwrap_or(0);
    if !cpus.contains(&cpu) {
        return Err(format!(
            "--cpu {cpu}: expected one of the processors of this process: {cpus:?}"
        ));
    }
    for (name, seconds) in [
        ("--seconds", args.seconds),
        ("--round-seconds", args.round_seconds),
    ] {
        if !(0.0..=SECONDS_MAX).contains(&seconds) {
            return Err(format!("{name} {seconds}: expected 0 to {SECONDS_MAX} seconds"));
        }
    }
    if args.against.is_some() && args.round_seconds < 1.0 {
        return Err("--round-seconds: expected at least 1".into());
    }
    if args.period < Span::micros(100)
        || args.period > Span::millis(100)
        || !args.period.0.is_multiple_of(2_000)
        || 1_000_000_000 % args.period.0 != 0
    {
        return Err(format!(
            "--period {}: expected an even number of microseconds from 100us to 100ms of which a second is a multiple",
            args.period
        ));
    }
    if args.spin.0 * 2 > args.period.0 / 2 {
        return Err(format!(
            "--spin {}: expected at most a quarter of the period",
            args.spin
        ));
    }
    Ok(Asked {
        load: args.load,
        length: Duration::from_secs_f64(args.seconds),
        cpu,
        other_cpu: cpus.iter().copied().find(|c| *c != cpu).unwrap_or(cpu),
        priority: args.priority,
        period: args.period,
        spin: args.spin,
        creature_spins: args.spinning,
        against: args.against,
        rounds: args.rounds,
        to_the_end_of_doubt: args.gate,
        round: Duration::from_secs_f64(args.round_seconds),
        plant: args.plant,
    })
}

fn answer(args: &LatencyArgs, asked: &Asked, outcome: &Outcome, json: bool) -> ExitCode {
    let compared = compare(asked, outcome);
    let allocations = daemon::alloc::broken();
    let faults = gate::faults(&compared, &outcome.kept, allocations, &outcome.refusals);
    let summary = summary(asked, outcome, &compared, allocations, &faults);
    let table = table(asked, outcome, &compared, allocations, &faults);
    if let Err(e) = report::write(&args.out, outcome.began, &outcome.tracks, &summary, &table) {
        eprintln!("subsumectl latency: {}: {e}", args.out.display());
        return ExitCode::FAILURE;
    }
    if json {
        println!("{summary:#}");
    } else {
        println!("{table}\nfiles: {}", args.out.display());
    }
    if args.gate && !faults.is_empty() {
        faults.iter().for_each(|fault| eprintln!("gate: {fault}"));
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn summary(
    asked: &Asked,
    outcome: &Outcome,
    compared: &[Compared],
    allocations: u64,
    faults: &[String],
) -> Value {
    let uname = rustix::system::uname();
    let plant = asked.plant.map(|p| format!("{p:?}").to_lowercase());
    json!({
        "kernel": uname.release().to_string_lossy(), "machine": uname.machine().to_string_lossy(),
        "load": asked.load.name(), "cpu": asked.cpu, "priority": asked.priority,
        "period_ns": asked.period.0, "spin_ns": asked.spin.0,
        "creature_wakes_by": if asked.creature_spins { "spin" } else { "sleep" },
        "rounds": outcome.rounds_of(Contest::Sleep).count().max(outcome.across.len()), "round_s": asked.round.as_secs_f64(),
        "unheard_rounds": outcome.unheard, "interrupted": outcome.interrupted, "planted": plant,
        "refusals": outcome.refusals, "threads": outcome.kept, "allocations": allocations,
        "churn_events": outcome.churn_events, "compared": compared, "faults": faults,
        "tracks": outcome.tracks.iter().map(report::describe).collect::<Vec<_>>(),
    })
}

fn table(
    asked: &Asked,
    outcome: &Outcome,
    compared: &[Compared],
    allocations: u64,
    faults: &[String],
) -> String {
    let wakes = if asked.creature_spins {
        format!("spin {}", asked.spin)
    } else {
        "sleep".into()
    };
    let mut out = format!(
        "## Latency under load `{}`\n\nprocessor {}, period {}, the creature waits by {wakes}{}{}\n\n\
         Times in microseconds, nothing of them a gate:\n\n",
        asked.load.name(),
        asked.cpu,
        asked.period,
        if outcome.interrupted {
            ", **interrupted**"
        } else {
            ""
        },
        asked
            .plant
            .map_or(String::new(), |p| format!(", **planted: {p:?}**")),
    );
    out.push_str(&report::table::of(&outcome.tracks));
    if !compared.is_empty() {
        out.push_str("\n| ratio | at | median (min–max, spread) | geometric mean | limit | |\n|---|---|---|---:|---:|---|\n");
        for c in compared {
            let limit = c.limit.map_or("–".into(), |l| format!("{l:.2}"));
            let verdict = c.verdict().map_or("", Verdict::word);
            let _ = writeln!(
                out,
                "| {} | {} | {} | {:.2} | {limit} | {verdict} |",
                c.what, c.quantile, c.ratio, c.ratio.mean
            );
        }
    }
    out.push_str("\n| thread | beats | missed | in a row | skipped | page faults | sleeps |\n|---|---:|---:|---:|---:|---:|---:|\n");
    for k in &outcome.kept {
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {} | {} | {} |",
            k.thread, k.beats, k.missed, k.missed_in_row_max, k.skipped, k.faults, k.sleeps
        );
    }
    let _ = writeln!(out, "\nallocations on real-time threads: {allocations}");
    if outcome.churn_events > 0 {
        let _ = writeln!(out, "came, left or were killed: {}", outcome.churn_events);
    }
    if outcome.unheard > 0 {
        let _ = writeln!(
            out,
            "**not measured**: {} rounds whose listener had its processor too rarely: this host is busy",
            outcome.unheard
        );
    }
    for refusal in &outcome.refusals {
        let _ = writeln!(out, "**best effort**: {refusal}");
    }
    for fault in faults {
        let _ = writeln!(out, "**outside the margins**: {fault}");
    }
    out
}
