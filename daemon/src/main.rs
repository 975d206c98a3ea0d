//! `subsumed`: runs a creature.

use std::net::SocketAddr;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use daemon::control::{self, Control};
use daemon::machine::{Machine, kinds};
use daemon::metrics::{self, Endpoint, Metrics};
use daemon::options::Options;
use daemon::running::{self, Running};
use daemon::view::View;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};

#[global_allocator]
static ALLOCATOR: daemon::alloc::Counting = daemon::alloc::Counting;

fn main() -> ExitCode {
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
            Source::new(path.display().to_string(), text)
        }
    };
    let mut creature = check::creature(&source, &kinds()).map_err(|rejected| rejected.to_string())?;
    creature.seed = options.seed.unwrap_or(creature.seed);
    if let Some(name) = &options.name {
        let sound = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || name.len() > 48 || !name.chars().all(sound) {
            return Err(format!(
                "--name {name:?}: expected 1 to 48 letters, digits, '-' or '_'"
            ));
        }
        creature.name = name.clone();
    }
    if options.seconds.is_some_and(|s| !s.is_finite() || s <= 0.0) {
        return Err("--seconds: expected a number of seconds above zero".into());
    }
    Ok((creature, source.text))
}

/// Runs the creature until a signal comes or the time is over.
fn run(options: &Options, creature: Creature, file: String) -> Result<(), String> {
    let leave = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, leave.clone()).map_err(|e| format!("signal {signal}: {e}"))?;
    }
    let name = creature.name.clone();
    control::claim(&name).map_err(|e| e.to_string())?;
    let domain = Domain::join(&name).map_err(|e| e.to_string())?;
    let owned = domain
        .own(&name, output_ports(&creature).count())
        .map_err(|e| e.to_string())?;
    let machine = Machine::new(creature, &kinds(), owned.page().clone(), None);
    let settings = options.recorder(file);
    let running = running::start(&name, machine, owned, domain, &settings)
        .map_err(|e| format!("starting threads and recordings: {e}"))?;
    let control =
        Control::open(&name, running.shared.clone()).map_err(|e| format!("the control socket: {e}"));
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
        wait(options, &leave);
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
    let address = SocketAddr::from(([127, 0, 0, 1], options.page_port));
    page::serve(address, Arc::new(View(running.shared.clone())))
        .map(Some)
        .map_err(|e| e.to_string())
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
    println!("plug the next layer in, from another terminal: cargo run --release -p allen");
    println!("ask it: cargo run --release -p tools -- status        leave: Ctrl-C");
}

fn wait(options: &Options, leave: &AtomicBool) {
    let began = Instant::now();
    let limit = options.seconds.map(Duration::from_secs_f64);
    while !leave.load(Ordering::Relaxed) && limit.is_none_or(|limit| began.elapsed() < limit) {
        std::thread::sleep(Duration::from_millis(20));
    }
}
