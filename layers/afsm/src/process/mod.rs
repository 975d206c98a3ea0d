//! A layer as a process of its own: attaches to a running creature, beats, detaches.
//!
//! ```text
//!   call ─► directory ─► check manifest ─► share own wires ─► plug ─► beat … beat ─► detach
//!    ▲                                                          │
//!    └──────────── daemon gone: try again four times a second ──┘
//! ```
//! Three threads: one beats, one serves the layer's wires to newcomers (`session`), one does what the daemon
//! says of other layers that tap its ports or share their wires anew (`attendant`).
//!
//! Must never be trusted: everything it writes is checked again where it arrives.

mod attendant;
mod session;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::control::{self, CallError};
use ipc::wire::iceoryx::ShareError;
use ipc::wiring::{Rejected, Source, check};

use crate::kind::Kinds;

pub use session::plug_request;

use session::attach;

/// How often a layer without a daemon looks for one.
const RETRY: Duration = Duration::from_millis(250);

/// Runs a layer process to its end: what its `main` calls.
///
/// Arguments: `--creature NAME` (default: the one the manifest names), `--once` (leave when the daemon
/// leaves), `--wait` (try until let in), `--help`. Status: 0 after a signal, 1 when refused or the daemon is gone, 2 for bad input.
pub fn run(manifest: Source, kinds: Kinds) -> ExitCode {
    run_with(manifest, kinds, std::env::args().skip(1))
}

/// [`run`] with arguments of the caller's choice: what is left of its own when it has taken some for itself.
pub fn run_with(manifest: Source, kinds: Kinds, arguments: impl Iterator<Item = String>) -> ExitCode {
    match Options::read(arguments) {
        Ok(options) => match attend(&manifest, &kinds, &options) {
            Ok(()) => ExitCode::SUCCESS,
            Err(Trouble::Manifest(rejected)) => {
                eprintln!("{rejected}");
                ExitCode::from(2)
            }
            Err(trouble) => {
                eprintln!("{trouble}");
                ExitCode::FAILURE
            }
        },
        Err(Asked::Help) => {
            println!("{}", help(&manifest));
            ExitCode::SUCCESS
        }
        Err(Asked::Nonsense(what)) => {
            eprintln!("{what}\n\n{}", help(&manifest));
            ExitCode::from(2)
        }
    }
}

fn help(manifest: &Source) -> String {
    format!(
        "A layer of a subsumption creature, as a process of its own ({}).\n\n\
         Usage: {} [--creature NAME] [--once] [--wait]\n\n\
         \x20 --creature NAME  the running creature to join (default: the one the manifest names)\n\
         \x20 --once           leave when the daemon leaves, instead of waiting for the next one\n\
         \x20 --wait           try until it is let in: for a layer that taps another, which may come later\n\
         \x20 --help           this text\n\n\
         Example: {} --creature allen\n\
         Ctrl-C detaches and leaves; the creature goes on with the layers below.",
        manifest.name,
        program(),
        program(),
    )
}

fn program() -> String {
    let path = std::env::args().next().unwrap_or_default();
    path.rsplit('/').next().unwrap_or("layer").to_string()
}

#[derive(Default)]
struct Options {
    creature: Option<String>,
    once: bool,
    wait: bool,
}

enum Asked {
    Help,
    Nonsense(String),
}

impl Options {
    fn read(mut args: impl Iterator<Item = String>) -> Result<Options, Asked> {
        let mut options = Options::default();
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--help" | "-h" => return Err(Asked::Help),
                "--once" => options.once = true,
                "--wait" => options.wait = true,
                "--creature" => {
                    let name = args
                        .next()
                        .ok_or_else(|| Asked::Nonsense("--creature needs a name".into()))?;
                    options.creature = Some(name);
                }
                other => return Err(Asked::Nonsense(format!("unknown argument {other:?}"))),
            }
        }
        Ok(options)
    }
}

/// Why a layer could not be attached.
#[derive(Debug)]
enum Trouble {
    Call(CallError),
    Manifest(Rejected),
    Share(ShareError),
    Refused(Vec<String>),
    Host(std::io::Error),
}

impl std::fmt::Display for Trouble {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Trouble::Call(e) => e.fmt(f),
            Trouble::Manifest(e) => e.fmt(f),
            Trouble::Share(e) => e.fmt(f),
            Trouble::Refused(reasons) => write!(f, "refused: {}", reasons.join("; ")),
            Trouble::Host(e) => e.fmt(f),
        }
    }
}

/// Attaches, again and again if need be, until told to leave.
fn attend(manifest: &Source, kinds: &Kinds, options: &Options) -> Result<(), Trouble> {
    let leave = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, leave.clone()).map_err(Trouble::Host)?;
    }
    let creature = match &options.creature {
        Some(name) => name.clone(),
        None => declared_creature(manifest, kinds)?,
    };
    let mut attached_before = false;
    let mut told = String::new();
    while !leave.load(Ordering::Relaxed) {
        match attach(manifest, kinds, &creature) {
            Ok(session) => {
                attached_before = true;
                told.clear();
                let name = session.layer.clone();
                eprintln!("layer {name} attached to {creature}; Ctrl-C detaches");
                session.beat(&leave);
                if leave.load(Ordering::Relaxed) {
                    eprintln!("layer {name} detached");
                    return Ok(());
                }
                eprintln!(
                    "the daemon of {creature} is gone{}",
                    if options.once {
                        ""
                    } else {
                        "; waiting for the next one"
                    }
                );
                if options.once {
                    return Err(Trouble::Call(CallError::NoDaemon {
                        creature,
                        others: control::running(),
                    }));
                }
            }
            // Told to leave, it does not matter what came of it. Before the first success a refusal is final;
            // afterwards the daemon may just not be back yet, or a layer whose ports this one taps.
            Err(_) if leave.load(Ordering::Relaxed) => return Ok(()),
            Err(trouble) if !attached_before && !options.wait => return Err(trouble),
            Err(Trouble::Call(CallError::NoDaemon { .. })) => {}
            Err(trouble) => {
                let text = trouble.to_string();
                if text != told {
                    eprintln!("not attached yet: {text}");
                    told = text;
                }
            }
        }
        std::thread::sleep(RETRY);
    }
    Ok(())
}

/// The creature that the manifest names. The manifest itself is checked against the running creature later.
fn declared_creature(manifest: &Source, kinds: &Kinds) -> Result<String, Trouble> {
    let named = manifest.text.lines().find_map(|line| {
        let value = line
            .trim()
            .strip_prefix("creature")?
            .trim_start()
            .strip_prefix('=')?
            .trim();
        Some(value.trim_matches('"').to_string())
    });
    named.map_or_else(
        || {
            check::creature(manifest, kinds)
                .map(|c| c.name)
                .map_err(Trouble::Manifest)
        },
        Ok,
    )
}
