//! `subsumectl doctor`: whether a host can keep a period, and what to change where it can't.
//!
//! Must never change anything: every call is tried on a thread or in a process of its own and taken back.

mod grants;
mod kernel;
mod processors;
mod shared_memory;

use std::process::ExitCode;

use ipc::clock::Span;
use serde::Serialize;
use serde_json::json;

/// Arguments of `subsumectl doctor`.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    subsumectl doctor                   what this host offers\n  \
    subsumectl doctor --period 1ms      whether a period of a millisecond can be kept here\n  \
    subsumectl --json doctor            the same for a program\n\n\
    What holds for the daemon is what its own unit is granted: run it there, with the same user and limits.\n\
    Status: 0 fit, or no period was asked for; 1 the period cannot be guaranteed; 2 bad input.")]
pub(crate) struct DoctorArgs {
    /// The period that is to be kept
    #[arg(long, value_name = "TIME", value_parser = Span::parse)]
    period: Option<Span>,
}

/// How a finding bears on a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Bearing {
    /// As it should be.
    Good,
    /// To know; it takes no guarantee away.
    Note,
    /// No guarantee for the period that was asked for.
    Bad,
}

/// What was found out about one thing.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Finding {
    /// What was looked at.
    what: &'static str,
    /// What was found.
    found: String,
    /// How it bears on the period.
    bearing: Bearing,
    /// What that means.
    means: String,
    /// What to change, word by word; empty if nothing.
    change: String,
}

impl Finding {
    fn new(
        what: &'static str,
        found: impl Into<String>,
        bearing: Bearing,
        means: impl Into<String>,
    ) -> Finding {
        Finding {
            what,
            found: found.into(),
            bearing,
            means: means.into(),
            change: String::new(),
        }
    }

    fn change(mut self, change: impl Into<String>) -> Finding {
        self.change = change.into();
        self
    }
}

/// Looks at the host.
pub(crate) fn doctor(args: &DoctorArgs, json: bool) -> ExitCode {
    if args.period == Some(Span::ZERO) {
        eprintln!("subsumectl doctor: --period: expected a time longer than zero, such as \"1ms\"");
        return ExitCode::from(2);
    }
    let mut findings = kernel::look(args.period);
    findings.extend(grants::look(args.period));
    findings.extend(processors::look(args.period));
    findings.extend(shared_memory::look());
    let bad = findings.iter().filter(|f| f.bearing == Bearing::Bad).count();
    let kept = bad == 0;
    if json {
        let period = args.period.map(|p| p.0);
        println!(
            "{:#}",
            json!({ "period_ns": period, "guaranteed": args.period.map(|_| kept), "findings": findings })
        );
    } else {
        show(&findings, args.period, bad);
    }
    if args.period.is_some() && !kept {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

fn show(findings: &[Finding], period: Option<Span>, bad: usize) {
    for f in findings {
        let mark = match f.bearing {
            Bearing::Good => "good",
            Bearing::Note => "note",
            Bearing::Bad => "BAD ",
        };
        println!("{mark}  {:<22} {}", f.what, f.found);
        if f.bearing != Bearing::Good {
            println!("      {}", f.means);
        }
        if !f.change.is_empty() {
            println!("      change: {}", f.change.replace('\n', "\n              "));
        }
    }
    match period {
        None => println!(
            "\nno period was asked for; `subsumectl doctor --period 1ms` says whether it can be kept"
        ),
        Some(period) if bad == 0 => println!(
            "\nnothing here stands against a period of {period}; how late beats are, `subsumectl latency --period {period}` measures"
        ),
        Some(period) => println!(
            "\na period of {period} cannot be guaranteed here: {bad} of {} findings stand against it",
            findings.len()
        ),
    }
}

/// A file's text without the end of its line; `None` if it can't be read.
fn text(path: &str) -> Option<String> {
    Some(std::fs::read_to_string(path).ok()?.trim().to_string())
}
