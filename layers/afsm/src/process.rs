//! A layer as a process of its own: attaches to a running creature, beats, detaches.
//!
//! ```text
//!   call ─► directory ─► check manifest ─► share own wires ─► plug ─► beat … beat ─► detach
//!    ▲                                                          │
//!    └──────────── daemon gone: try again four times a second ──┘
//! ```
//!
//! Must never be trusted: everything it writes is checked again where it arrives.

use std::collections::HashMap;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock::{self, Span, Time};
use ipc::control::{self, CallError, Connection, Plug, PlugModule, PlugTap, Reply, Request};
use ipc::wire::iceoryx::{Domain, ShareError};
use ipc::wire::{Page, Reader};
use ipc::wiring::creature::{Creature, PortName};
use ipc::wiring::directory::{Directory, Listed};
use ipc::wiring::{Rejected, Source, check};

use crate::assemble::{FiledTap, Wires, assemble};
use crate::kind::Kinds;
use crate::layer::RunningLayer;

/// How often a layer without a daemon looks for one.
const RETRY: Duration = Duration::from_millis(250);

/// How often newcomers to this layer's wires are served.
const SERVE: Duration = Duration::from_millis(5);

/// Runs a layer process to its end: what its `main` calls.
///
/// Arguments: `--creature NAME` (default: the one the manifest names), `--once` (leave when the daemon
/// leaves), `--help`. Status: 0 after a signal, 1 when refused or the daemon is gone, 2 for bad input.
pub fn run(manifest: Source, kinds: Kinds) -> ExitCode {
    match Options::read(std::env::args().skip(1)) {
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
         Usage: {} [--creature NAME] [--once]\n\n\
         \x20 --creature NAME  the running creature to join (default: the one the manifest names)\n\
         \x20 --once           leave when the daemon leaves, instead of waiting for the next one\n\
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
    while !leave.load(Ordering::Relaxed) {
        match attach(manifest, kinds, &creature) {
            Ok(session) => {
                attached_before = true;
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
            // Before the first success a refusal is final; afterwards the daemon may just not be back yet.
            Err(trouble) if !attached_before => return Err(trouble),
            Err(Trouble::Manifest(rejected)) => return Err(Trouble::Manifest(rejected)),
            Err(_) => {}
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

/// An attached layer.
struct Session {
    layer: String,
    period: Span,
    running: RunningLayer,
    connection: Connection,
    gone: Arc<AtomicBool>,
    keeper: Option<std::thread::JoinHandle<()>>,
}

impl Session {
    /// Beats until told to leave or the daemon is gone.
    fn beat(mut self, leave: &AtomicBool) {
        let gone = self.gone.clone();
        let mut next = clock::monotonic();
        while !leave.load(Ordering::Relaxed) && !gone.load(Ordering::Relaxed) {
            self.running.step(clock::monotonic());
            self.running.commit(clock::monotonic());
            next = next + self.period;
            let now = clock::monotonic();
            if next < now {
                next = skip_to(next, now, self.period);
            }
            clock::sleep_until(next);
        }
        // If the daemon is gone already there is nobody to tell.
        let _ = self.connection.send(&Request::Unplug);
        gone.store(true, Ordering::Relaxed);
        let _ = self.connection.socket().shutdown(std::net::Shutdown::Both);
        if let Some(keeper) = self.keeper.take() {
            let _ = keeper.join();
        }
    }
}

/// The first beat of the grid of `next` that is not before `now`.
fn skip_to(next: Time, now: Time, period: Span) -> Time {
    let missed = now.since(next).0.div_ceil(period.0);
    next + Span(missed * period.0)
}

/// The wires a layer process can read: its own and those of the processes it mapped.
struct Neighbours {
    creature: Creature,
    own: Arc<Page>,
    directory: Directory,
    pages: HashMap<String, Arc<Page>>,
}

impl Wires for Neighbours {
    fn reader(&self, output: &PortName) -> Option<Reader> {
        let own = ipc::wiring::directory::output_ports(&self.creature);
        if let Some((index, (_, port, _))) = own.enumerate().find(|(_, (name, ..))| name == output) {
            return self.own.reader(index, port.kind);
        }
        let listed = self
            .directory
            .outputs
            .iter()
            .find(|l| l.name == output.to_string())?;
        self.pages.get(&listed.owner)?.reader(listed.index, listed.kind)
    }
}

fn attach(manifest: &Source, kinds: &Kinds, creature_name: &str) -> Result<Session, Trouble> {
    let mut connection = control::call(creature_name, &program()).map_err(Trouble::Call)?;
    let directory = match connection.ask(&Request::Directory).map_err(Trouble::Host)? {
        Reply::Directory(directory) => directory,
        other => return Err(Trouble::Refused(vec![format!("unexpected answer {other:?}")])),
    };
    let creature = check::manifest(manifest, kinds, &directory).map_err(Trouble::Manifest)?;
    let [layer] = creature.layers.as_slice() else {
        return Err(Trouble::Refused(vec![
            "a layer process runs one [[layer]]".into(),
        ]));
    };
    let layer = layer.clone();
    let domain = Domain::join(&layer.name).map_err(Trouble::Share)?;
    let owner = format!("{creature_name}/{}", layer.name);
    let outputs: Vec<Listed> = Directory::of(&creature, &owner).outputs;
    let owned = domain.own(&owner, outputs.len()).map_err(Trouble::Share)?;
    let page = owned.page().clone();
    let mut pages = HashMap::new();
    for wire in &layer.wires {
        let Some(listed) = directory.outputs.iter().find(|l| l.name == wire.from.to_string()) else {
            continue;
        };
        if !pages.contains_key(&listed.owner) {
            pages.insert(
                listed.owner.clone(),
                domain.map(&listed.owner).map_err(Trouble::Share)?,
            );
        }
    }
    let gone = Arc::new(AtomicBool::new(false));
    // From now on newcomers, the daemon first of all, get this layer's page.
    let keeper_gone = gone.clone();
    let keeper = std::thread::spawn(move || {
        while !keeper_gone.load(Ordering::Relaxed) {
            owned.serve();
            std::thread::sleep(SERVE);
        }
        drop((owned, domain));
    });
    let request = plug_request(&layer, &owner, outputs, std::process::id());
    let neighbours = Neighbours {
        creature,
        own: page.clone(),
        directory,
        pages,
    };
    let seed = u64::from(std::process::id()) ^ clock::monotonic().0;
    let none: &[FiledTap] = &[];
    let (running, _hand) = assemble(&layer, kinds, &page, 0, &neighbours, none, seed);
    let answer = connection.ask(&Request::Plug(request));
    let plugged = match answer {
        Ok(Reply::Plugged { .. }) => watch(&connection, gone.clone()).map_err(Trouble::Host),
        Ok(Reply::Refused { reasons }) => Err(Trouble::Refused(reasons)),
        Ok(other) => Err(Trouble::Refused(vec![format!("unexpected answer {other:?}")])),
        Err(e) => Err(Trouble::Host(e)),
    };
    if let Err(trouble) = plugged {
        gone.store(true, Ordering::Relaxed);
        let _ = keeper.join();
        return Err(trouble);
    }
    Ok(Session {
        layer: layer.name,
        period: layer.period,
        running,
        connection,
        gone,
        keeper: Some(keeper),
    })
}

/// Notices when the daemon closes the connection.
fn watch(connection: &Connection, gone: Arc<AtomicBool>) -> std::io::Result<()> {
    let socket = connection.socket().try_clone()?;
    socket.set_read_timeout(None)?;
    std::thread::spawn(move || {
        let mut other_end = &socket;
        let mut byte = [0];
        while matches!(std::io::Read::read(&mut other_end, &mut byte), Ok(1..)) {}
        gone.store(true, Ordering::Relaxed);
    });
    Ok(())
}

/// What `layer` asks of the creature that it joins. It shares its `outputs` as `owner`, from process `pid`.
pub fn plug_request(
    layer: &ipc::wiring::creature::Layer,
    owner: &str,
    outputs: Vec<Listed>,
    pid: u32,
) -> Plug {
    let names = |ports: &[ipc::wiring::Port]| ports.iter().map(|p| p.name.to_string()).collect();
    let module = |m: &ipc::wiring::creature::Module| PlugModule {
        name: m.name.clone(),
        kind: m.declaration.name.into(),
        inputs: names(m.declaration.inputs),
        outputs: names(m.declaration.outputs),
    };
    let tap = |t: &ipc::wiring::creature::Tap| PlugTap {
        how: t.how,
        from: t.from.to_string(),
        to: t.to.to_string(),
        time_constant: t.time_constant,
    };
    Plug {
        layer: layer.name.clone(),
        level: layer.level,
        period: layer.period,
        pid,
        owner: owner.into(),
        outputs,
        modules: layer.modules.iter().map(module).collect(),
        wires: layer
            .wires
            .iter()
            .map(|w| (w.from.to_string(), w.to.to_string()))
            .collect(),
        taps: layer.taps.iter().map(tap).collect(),
    }
}
