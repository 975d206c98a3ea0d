//! What tracing and recording cost a real-time thread: a layer that writes a hundred wires at 1 kHz.
//!
//! Must never run longer than it was told: it ends by itself, and the kernel ends it if a thread runs away.
//!
//! `traced`: traced, fetched and kept by a flight recorder's ring, against its twin that is not traced at all; both at
//! the same time on the same core, half a period apart, phases swapped every round.
//!
//! `recorded`: traced while a listener writes an MCAP file of it, against the same thread traced with nobody
//! listening; turn about every fifth of a second, in the order A B B A, so that what the listener takes from the
//! caches of the processor counts as well. The first 50 ms of a turn are left out.
//!
//! ```sh
//! cargo run --release -p tests --example trace_cost -- [ROUNDS [SECONDS]]
//! ```

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use afsm::layer::RunningLayer;
use afsm::trace::{Trace, trace};
use daemon::executor::plan::Schedule;
use daemon::executor::{self, Beating, Beats, Plan, host};
use daemon::halt::HaltChannel;
use daemon::machine::{Machine, kinds};
use daemon::recorder::FLIGHT_SPAN;
use ipc::clock::{self, Span, Time};
use ipc::wire::Page;
use ipc::wiring::creature::{Overrun, Wake};
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};
use recording::ring::RING_BYTES_MAX;
use recording::{Item, Manifest, Ring, Writer};

const PERIOD: Span = Span::millis(1);

/// How often the daemon's recorder fetches.
const FETCH: Duration = Duration::from_millis(10);

/// How long a listener listens, or doesn't.
const TURN: Duration = Duration::from_millis(200);

/// What of it is left out.
const SETTLE: Duration = Duration::from_millis(50);

struct Layer(RunningLayer);

impl Beats for Layer {
    fn beat(&mut self, now: Time) {
        self.0.step(now);
        self.0.commit(clock::monotonic());
    }
}

/// Fifty pairs of Allen's `turn` and `forward`: each writes its rate or speed with every beat, by one compass.
fn text() -> String {
    let mut text = String::from(
        "creature = \"hundred\"\n[[layer]]\nname = \"many\"\nlevel = 0\nperiod = \"1ms\"\nwires = [\n",
    );
    for k in 0..50 {
        let _ = writeln!(
            text,
            "\"t{k}.go -> f{k}.go\", \"f{k}.done -> t{k}.done\", \"north.out -> t{k}.compass\","
        );
    }
    text += "]\n[layer.modules]\nnorth = { kind = \"constant\", value = 0.0, every = \"1ms\" }\n";
    for k in 0..50 {
        let _ = writeln!(
            text,
            "t{k} = {{ kind = \"allen.turn\" }}\nf{k} = {{ kind = \"allen.forward\" }}"
        );
    }
    text
}

fn start(
    phase: Span,
    traced: bool,
    begin: Time,
    stop: &Arc<AtomicBool>,
) -> (Beating, Option<Trace>, Arc<Manifest>) {
    let creature = check::creature(&Source::new("hundred.toml", text()), &kinds());
    let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}"));
    let manifest = Arc::new(Manifest::of(&creature, "hundred", &text(), begin, Vec::new()));
    let page = Page::in_memory(output_ports(&creature).count());
    let station = Machine::new(creature, &kinds(), page, None).stations.remove(0);
    let (mut running, mut out) = (station.running, None);
    if traced {
        let (tracer, end) = trace(PERIOD, running.ports().0, running.ports().1);
        running.trace(tracer);
        out = Some(end);
    }
    let plan = Plan {
        name: if traced { "traced" } else { "plain" }.into(),
        period: PERIOD,
        phase,
        schedule: Schedule::Fifo(40),
        cpu: Some(0),
        wake: Wake::Sleep,
        overrun: Overrun::Skip,
        sealed: true,
    };
    let halt = Arc::new(HaltChannel::default());
    let beating = executor::start(
        plan,
        begin,
        Layer(running),
        vec![Arc::default()],
        halt,
        stop.clone(),
    );
    (beating.expect("the host gives a thread"), out, manifest)
}

/// What a recorder keeps for a flight: nobody may be listening.
fn flight(manifest: &Manifest) -> Ring {
    Ring::new(manifest, FLIGHT_SPAN, RING_BYTES_MAX)
}

/// The steps of `beating` that were not fetched yet, in nanoseconds.
fn steps(beating: &mut Beating) -> impl Iterator<Item = u64> {
    std::iter::from_fn(|| beating.samples[0].pop().ok()).map(|sample| sample.step.0)
}

/// Steps of the twins for `seconds`, not traced first; and how many beats the trace lost.
fn traced(seconds: u64, traced_first: bool) -> ([Vec<u64>; 2], u64) {
    let stop = Arc::new(AtomicBool::new(false));
    let begin = clock::monotonic() + Span::millis(100);
    let half = Span(PERIOD.0 / 2);
    let (first, second) = if traced_first {
        (half, Span::ZERO)
    } else {
        (Span::ZERO, half)
    };
    let (mut plain, ..) = start(first, false, begin, &stop);
    let (mut traced, out, manifest) = start(second, true, begin, &stop);
    let mut out = out.expect("this one is traced");
    let mut ring = flight(&manifest);
    let mut took = [Vec::new(), Vec::new()];
    let until = Instant::now() + Duration::from_secs(seconds);
    while Instant::now() < until {
        std::thread::sleep(FETCH);
        while let Some(words) = out.next_beat() {
            ring.push(Item::Beat { source: 0, words });
        }
        took[0].extend(steps(&mut plain));
        took[1].extend(steps(&mut traced));
    }
    stop.store(true, Ordering::Relaxed);
    plain.join();
    traced.join();
    (took, out.lost())
}

/// Steps of one traced layer for `seconds`, with nobody listening first; and how many beats the trace lost.
fn recorded(seconds: u64, listened_first: bool) -> ([Vec<u64>; 2], u64) {
    let stop = Arc::new(AtomicBool::new(false));
    let begin = clock::monotonic() + Span::millis(100);
    let (mut beating, out, manifest) = start(Span::ZERO, true, begin, &stop);
    let mut out = out.expect("it is traced");
    let mut ring = flight(&manifest);
    let path = std::env::temp_dir().join(format!("trace-cost-{}.mcap", std::process::id()));
    let file = std::io::BufWriter::new(std::fs::File::create(&path).expect("a temporary file"));
    let (items, heard) = std::sync::mpsc::channel::<Item>();
    let listener = std::thread::spawn(move || {
        let mut writer = Writer::new(file, &manifest).expect("the file takes it");
        for item in heard {
            writer.write(&item).expect("the file takes it");
        }
        writer.finish().expect("the file takes it");
    });
    let mut took = [Vec::new(), Vec::new()];
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(seconds) {
        std::thread::sleep(FETCH);
        let turn = (began.elapsed().as_nanos() / TURN.as_nanos()) as u32;
        let listened = matches!(turn % 4, 1 | 2) != listened_first;
        while let Some(words) = out.next_beat() {
            let item = Item::Beat { source: 0, words };
            if listened {
                items.send(item.clone()).expect("the listener listens");
            }
            ring.push(item);
        }
        let new = steps(&mut beating);
        if began.elapsed() - TURN * turn < SETTLE {
            new.for_each(drop);
        } else {
            took[usize::from(listened)].extend(new);
        }
    }
    stop.store(true, Ordering::Relaxed);
    beating.join();
    drop(items);
    listener.join().expect("the listener wrote all of it");
    std::fs::remove_file(path).expect("our own file");
    (took, out.lost())
}

fn quantile(steps: &mut [u64], q: f64) -> f64 {
    steps.sort_unstable();
    steps[((steps.len() - 1) as f64 * q) as usize] as f64 / 1e3
}

/// Geometric mean, smallest and largest of the rounds' ratios.
fn show(name: &str, ratios: &[f64]) {
    let mean = (ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64).exp();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    println!("  {name}: geometric mean {mean:.3}, rounds {least:.3} to {most:.3}");
}

/// Steps without and with, and how many beats were lost, of so many seconds; the second swaps the sides.
type Measured = fn(u64, bool) -> ([Vec<u64>; 2], u64);

fn compare(name: &str, rounds: u64, seconds: u64, measured: Measured) {
    println!(
        "{name:<9} {:>11} {:>7} {:>7} {:>11} {:>7} {:>7} {:>5}",
        "without p50", "with", "ratio", "without p99", "with", "ratio", "lost"
    );
    let mut ratios = [Vec::new(), Vec::new()];
    for round in 0..rounds {
        let ([mut without, mut with], lost) = measured(seconds, round % 2 == 1);
        print!("{round:<9}");
        for (q, ratios) in [0.5, 0.99].into_iter().zip(&mut ratios) {
            let (a, b) = (quantile(&mut without, q), quantile(&mut with, q));
            print!(" {a:>11.2} {b:>7.2} {:>7.3}", b / a);
            ratios.push(b / a);
        }
        println!(" {lost:>5}");
    }
    show("p50", &ratios[0]);
    show("p99", &ratios[1]);
}

fn main() {
    let mut args = std::env::args()
        .skip(1)
        .map(|a| a.parse::<u64>().expect("a number"));
    let (rounds, seconds) = (args.next().unwrap_or(6).max(1), args.next().unwrap_or(5).max(1));
    if let Err(refusal) = host::lock_memory() {
        println!("{refusal}");
    }
    host::limit_runaway();
    println!("microseconds of a step");
    compare("traced", rounds, seconds, traced);
    compare("recorded", rounds, seconds, recorded);
}
