//! The soak: Allen for minutes or hours while layers come, go, die, freeze, flood and lie, and now and then the body
//! has to halt. What is looked for is what grows, and what happens once in a thousand times.
//!
//! ```text
//!   soak ── stage ──► `faults soak-inside` ──► one daemon, one body, layers as the seed decides ──► report, JSON
//!     Ctrl-C ── SIGTERM ──► (ends its round, and reports what was measured)
//! ```
//! Must never end the daemon or the body in between: what grows would begin anew.

mod acts;
mod growth;
mod report;

use std::io::{IsTerminal, Read};
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use ipc::clock::{self, Span, Time};
use rustix::process::{Pid, Signal, kill_process};
use stage::{Player, Stage};

use crate::programs::{self, Programs};
use crate::suite;
use crate::trial::{BODY, CREATURE, Trial};
use acts::{Layers, Tally};
use growth::Growth;
use report::Report;

/// How long, and from which seed.
#[derive(Args, Clone, Debug)]
pub(crate) struct Options {
    /// How long, in minutes
    #[arg(long, default_value_t = 10.0, value_name = "N", value_parser = minutes)]
    minutes: f64,
    /// What decides who comes, goes and breaks when
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    /// The report as JSON
    #[arg(long)]
    json: bool,
}

/// Longest soak: a week.
const MINUTES_MAX: f64 = 7.0 * 24.0 * 60.0;

fn minutes(text: &str) -> Result<f64, String> {
    let minutes = text.parse::<f64>().ok();
    minutes
        .filter(|m| *m > 0.0 && *m <= MINUTES_MAX)
        .ok_or_else(|| format!("expected a number of minutes above 0, up to {MINUTES_MAX}"))
}

/// How often is measured.
const MEASURE: Span = Span::secs(2);

/// How often the bar is drawn on a terminal, and a line written elsewhere.
const DRAWN: Span = Span::millis(500);
const WRITTEN: Span = Span::secs(60);

/// Cells of the bar.
const BAR: usize = 30;

/// Runs a soak on a stage of its own, and shows its report. Says whether all was as it should be.
///
/// # Errors
/// When it cannot be run at all.
pub(crate) fn run(options: &Options) -> Result<bool, String> {
    programs::build()?;
    let programs = Programs::beside_us()?;
    let stage = Stage::new(&format!("soak{}", std::process::id()))?;
    let interrupted = suite::on_interrupt()?;
    let seconds = (options.minutes * 60.0).to_string();
    let seed = options.seed.to_string();
    let mut command = stage.command(&programs.ourselves);
    command.args(["soak-inside", "--seconds", &seconds, "--seed", &seed]);
    // Ctrl-C is for us: we tell it to come to an end.
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let child = command.stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|e| format!("the soak does not start: {e}"))?;
    let mut told = false;
    let mut out = child.stdout.take().ok_or("its standard output was not piped")?;
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        out.read_to_string(&mut text).map(|_| text)
    });
    let status = loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if interrupted.load(Ordering::Relaxed) && !told {
            told = true;
            let _ = kill_process(Pid::from_child(&child), Signal::TERM);
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let text = reader.join().map_err(|_| "nobody heard its report")?;
    let text = text.map_err(|e| e.to_string())?;
    let mut report: Report =
        serde_json::from_str(&text).map_err(|_| format!("the soak ended with {status} and no report"))?;
    report.left_behind(suite::left_behind(&stage));
    match options.json {
        true => println!("{:#}", report.json()),
        false => print!("{}", report.text()),
    }
    Ok(report.broken.is_empty())
}

/// The soak itself, on the stage that this process was started on; its report on standard output.
///
/// # Errors
/// When a process does not start.
pub(crate) fn inside(seconds: f64, seed: u64) -> Result<(), String> {
    let leave = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGTERM, leave.clone())
        .map_err(|e| format!("SIGTERM: {e}"))?;
    let mut trial = Trial::new(seed, 1)?.living(seconds);
    let mut body = trial.body()?;
    let mut daemon = trial.daemon(&["--body", BODY, "--flight-recorder", "off"])?;
    let mut layers = Layers::over(&mut trial, &daemon, pid_of(&body)?)?;
    layers.fill();
    let mut tally = Tally::default();
    let mut growth = Growth::of(daemon.pid(), body.pid());
    let (began, length) = (
        clock::monotonic(),
        Span::from_seconds(seconds).unwrap_or(Span::ZERO),
    );
    let (mut measured, mut bar) = (Time::ZERO, Bar::new(began, length));
    let mut trouble = None;
    while !leave.load(Ordering::Relaxed) && clock::monotonic().since(began) < length && trouble.is_none() {
        trouble = layers.act(&mut tally).err();
        let now = clock::monotonic();
        if now.since(measured) >= MEASURE {
            measured = now;
            let status = layers.status();
            tally.look(&status);
            growth.measure(now.since(began), layers.stage().segments().len());
        }
        bar.draw(now, &tally);
        layers.rest();
    }
    bar.end();
    layers.leave_all(&mut tally);
    if let Some(trouble) = trouble {
        tally.broken.push(trouble);
    }
    for player in [&mut daemon, &mut body] {
        tally.broken.extend(player.leave().err());
    }
    let report = Report::new(seed, clock::monotonic().since(began), length, tally, &growth);
    let text = serde_json::to_string(&report).map_err(|e| e.to_string())?;
    println!("{text}");
    Ok(())
}

fn pid_of(player: &Player) -> Result<Pid, String> {
    let pid = i32::try_from(player.pid()).ok().and_then(Pid::from_raw);
    pid.ok_or_else(|| "a process without a number".into())
}

/// How far it is.
struct Bar {
    began: Time,
    length: Span,
    drawn: Time,
    terminal: bool,
}

impl Bar {
    fn new(began: Time, length: Span) -> Bar {
        Bar {
            began,
            length,
            drawn: Time::ZERO,
            terminal: std::io::stderr().is_terminal(),
        }
    }

    fn draw(&mut self, now: Time, tally: &Tally) {
        let pause = if self.terminal { DRAWN } else { WRITTEN };
        if now.since(self.drawn) < pause {
            return;
        }
        self.drawn = now;
        let passed = now.since(self.began).seconds();
        let all = self.length.seconds();
        let full = ((passed / all).min(1.0) * BAR as f64) as usize;
        let text = format!(
            "[{}{}] {} of {}, {} acts, {} contacts caused, {} halts missed",
            "#".repeat(full),
            "-".repeat(BAR - full),
            minutes_of(passed),
            minutes_of(all),
            tally.acts(),
            tally.contacts,
            tally.missed,
        );
        match self.terminal {
            true => eprint!("\r{text} "),
            false => eprintln!("{text}"),
        }
    }

    fn end(&self) {
        if self.terminal {
            eprintln!();
        }
    }
}

fn minutes_of(seconds: f64) -> String {
    let seconds = seconds as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

/// Name of the creature whose status is looked at.
const SOAKED: &str = CREATURE;
