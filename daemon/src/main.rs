//! `subsumed`: runs a creature.

use std::net::SocketAddr;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use daemon::admission::Admission;
use daemon::control::{self, Control};
use daemon::executor::host;
use daemon::feeder::{self, Fed};
use daemon::machine::{Machine, cells_apart, kinds};
use daemon::metrics::{self, Endpoint, Metrics};
use daemon::options::Options;
use daemon::panicked;
use daemon::running::{self, Running};
use daemon::segment;
use daemon::view::View;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};
use mechanisms::desk::{self, Served};
use page::Token;

#[global_allocator]
static ALLOCATOR: daemon::alloc::Counting = daemon::alloc::Counting;

fn main() -> ExitCode {
    daemon::alloc::share_one_heap();
    let options = Options::parse();
    let (creature, file) = match load(&options) {
        Ok(loaded) => loaded,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    match run(&options, creature, file) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("subsumed: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Reads and checks the creature file; gives its text as well.
fn load(options: &Options) -> Result<(Creature, String), String> {
    let source = match &options.creature {
        None => Source::new("allen.toml (built in)", allen::CREATURE),
        Some(path) => {
            let text = std::fs::read_to_string(path).map_err(|e| {
                format!(
                    "{}: cannot be read: {e}; expected the path of a creature file (TOML)",
                    path.display()
                )
            })?;
            Source::of_file(path, text)
        }
    };
    let mut creature = check::creature(&source, &kinds()).map_err(|rejected| rejected.to_string())?;
    creature.seed = options.seed.unwrap_or(creature.seed);
    if let Some(name) = &options.name {
        if !daemon::is_name(name) {
            return Err(format!("--name {name:?}: {}", daemon::NAME_EXPECTED));
        }
        creature.name = name.clone();
    }
    if let Some(body) = &options.body {
        if !daemon::is_name(body) {
            return Err(format!("--body {body:?}: {}", daemon::NAME_EXPECTED));
        }
        if creature.body.is_none() {
            return Err(format!("--body {body:?}: the creature has no [body]"));
        }
    }
    if options.seconds.is_some_and(|s| !s.is_finite() || s <= 0.0) {
        return Err("--seconds: expected a number of seconds above zero".into());
    }
    if let Some(file) = &options.page_token {
        token(file)?;
    }
    Ok((creature, source.text))
}

/// Runs the creature until a signal comes or the time is over.
fn run(options: &Options, creature: Creature, file: String) -> Result<(), String> {
    let leave = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, leave.clone()).map_err(|e| format!("signal {signal}: {e}"))?;
    }
    let hup = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGHUP, hup.clone())
        .map_err(|e| format!("SIGHUP: {e}"))?;
    // Before any thread is made: none may inherit a real-time policy. What is refused here is said later.
    let _ = host::be_ordinary();
    let name = creature.name.clone();
    control::claim(&name).map_err(|e| e.to_string())?;
    panicked::guard();
    segment::guard().map_err(|e| format!("a handler for SIGBUS: {e}"))?;
    let domain = Domain::join(&name).map_err(|e| e.to_string())?;
    let cells = match options.body {
        Some(_) => cells_apart(&creature),
        None => output_ports(&creature).count(),
    };
    let owned = domain.own(&name, cells).map_err(|e| e.to_string())?;
    let admission = Admission::of(&creature.outsiders)?;
    let fed = Fed::open(creature.halt.watchdog_device.as_deref()).map_err(|e| e.to_string())?;
    let _commands = take_commands(options, &creature)?;
    let machine = match options.body {
        Some(_) => Machine::apart(creature, &kinds(), owned.page().clone()),
        None => Machine::new(creature, &kinds(), owned.page().clone(), None),
    };
    let (body, settings) = (options.body.as_deref(), options.recorder(file));
    let running = running::start(&name, machine, owned, domain, &settings, body, fed)
        .map_err(|e| format!("starting threads and recordings: {e}"))?;
    let control = Control::open(&name, running.shared.clone(), admission)
        .map_err(|e| format!("the control socket: {e}"));
    let page = serve_page(options, &running);
    let metrics = serve_metrics(options, &running);
    let result = control.and_then(|control| Ok((control, page?, metrics?)));
    let result = result.map(|(control, page, metrics)| {
        if !options.headless {
            introduce(&running, page.as_ref());
        }
        for address in metrics.iter().filter_map(|m| m.address) {
            println!("metrics: http://{address}/metrics");
        }
        wait(options, &leave, || reload(options, &hup, &running));
        if panicked::any() {
            running.leave_panicked();
        }
        if segment::cut() > 0 {
            running.leave_cut();
        }
        // Nobody is answered any more while the body comes to a halt.
        drop((control, page, metrics));
    });
    running.shut_down();
    result
}

fn serve_page(options: &Options, running: &Running) -> Result<Option<page::Server>, String> {
    if options.no_page || options.headless {
        return Ok(None);
    }
    let address = SocketAddr::from((options.page_address, options.page_port));
    let view = Arc::new(View(running.shared.clone()));
    let server = match &options.page_token {
        None => page::serve(address, view),
        Some(file) => page::serve_others(address, token(file)?, view),
    };
    server.map(Some).map_err(|e| e.to_string())
}

/// The token in a file.
fn token(file: &Path) -> Result<Token, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("--page-token {}: {e}", file.display()))?;
    Token::new(&text).ok_or_else(|| {
        format!(
            "--page-token {}: expected one line of {} to {} letters, digits and signs; \
             `openssl rand -hex 16` makes one",
            file.display(),
            Token::BYTES_MIN,
            Token::BYTES_MAX
        )
    })
}

/// Opens the desk at which the creature's hierarchy is told commands, before its module is built.
fn take_commands(options: &Options, creature: &Creature) -> Result<Option<Served>, String> {
    let Some(socket) = &options.commands else {
        return Ok(None);
    };
    let modules = creature.layers.iter().flat_map(|layer| &layer.modules);
    let served = desk::open_for(modules.map(|module| module.declaration.name), socket);
    served.map(Some).map_err(|e| format!("--commands: {e}"))
}

fn serve_metrics(options: &Options, running: &Running) -> Result<Vec<Metrics>, String> {
    let port = options.metrics_port.map(Endpoint::Port);
    let socket = options.metrics_socket.clone().map(Endpoint::Socket);
    port.iter()
        .chain(&socket)
        .map(|endpoint| metrics::serve(endpoint, running.shared.clone()).map_err(|e| e.to_string()))
        .collect()
}

fn introduce(running: &Running, page: Option<&page::Server>) {
    let shared = &running.shared;
    if running.refusals.is_empty() {
        println!("real time: memory is locked, threads run under SCHED_FIFO");
    } else {
        println!("BEST EFFORT: the host does not grant real time");
        running.refusals.iter().for_each(|r| println!("  {r}"));
    }
    let layers: Vec<String> = shared
        .creature
        .layers
        .iter()
        .map(|l| format!("level {} {} ({})", l.level, l.name, l.period))
        .collect();
    println!("{} is alive: {}", shared.name, layers.join(", "));
    println!(
        "wires: iceoryx2 service {}",
        ipc::wire::iceoryx::service_of(&shared.name)
    );
    if let Some(page) = page {
        println!("look at it: http://{}/", page.address());
    }
    // In the repository by way of cargo; elsewhere by the names that are installed.
    let by_cargo = std::env::var_os("CARGO").is_some();
    let (ctl, wander) = match by_cargo {
        true => ("cargo run --release -p tools --", "cargo run --release -p allen"),
        false => ("subsumectl", "allen-wander"),
    };
    let other = match shared.name.as_str() {
        "allen" => {
            println!("plug the next layer in, from another terminal: {wander}");
            String::new()
        }
        name => format!(" --creature {name}"),
    };
    println!("ask it: {ctl}{other} status        leave: Ctrl-C");
}

/// Reads the creature file again if SIGHUP asked for it; says what would change, and changes nothing.
fn reload(options: &Options, hup: &AtomicBool, running: &Running) {
    if !hup.swap(false, Ordering::Relaxed) {
        return;
    }
    feeder::reloading();
    for line in daemon::reload::report(
        &running.shared.creature,
        load(options).map(|(creature, _)| creature),
    ) {
        running.shared.events.note("reload", None, line);
    }
    feeder::reloaded();
}

fn wait(options: &Options, leave: &AtomicBool, look: impl Fn()) {
    let began = Instant::now();
    let limit = options.seconds.map(Duration::from_secs_f64);
    let goes_on = || !leave.load(Ordering::Relaxed) && segment::cut() == 0 && !panicked::any();
    while goes_on() && limit.is_none_or(|limit| began.elapsed() < limit) {
        look();
        std::thread::sleep(Duration::from_millis(20));
    }
}
