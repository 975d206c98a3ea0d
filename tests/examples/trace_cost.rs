//! What tracing costs a real-time thread: a layer that writes a hundred wires at 1 kHz, traced and recorded, against
//! its twin that isn't, at the same time on the same core, half a period apart; phases swapped every round.
//!
//! Must never run longer than it was told: it ends by itself, and the kernel ends it if a thread runs away.
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
use ipc::clock::{self, Span, Time};
use ipc::wire::Page;
use ipc::wiring::creature::{Overrun, Wake};
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};
use recording::{Item, Manifest, Writer};

const PERIOD: Span = Span::millis(1);

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

/// Steps of both for `seconds`, in nanoseconds, plain first; and how many beats the trace lost.
fn round(seconds: u64, traced_first: bool) -> ([Vec<u64>; 2], u64) {
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
    let mut writer = Writer::new(std::io::sink(), &manifest).expect("nothing takes anything");
    let mut steps = [Vec::new(), Vec::new()];
    let until = Instant::now() + Duration::from_secs(seconds);
    while Instant::now() < until {
        std::thread::sleep(Duration::from_millis(10));
        while let Some(words) = out.next_beat() {
            writer
                .write(&Item::Beat { source: 0, words })
                .expect("nothing takes anything");
        }
        for (beating, steps) in [&mut plain, &mut traced].into_iter().zip(&mut steps) {
            steps.extend(std::iter::from_fn(|| beating.samples[0].pop().ok()).map(|s| s.step.0));
        }
    }
    stop.store(true, Ordering::Relaxed);
    plain.join();
    traced.join();
    (steps, out.lost())
}

fn quantile(steps: &mut [u64], q: f64) -> f64 {
    steps.sort_unstable();
    steps[((steps.len() - 1) as f64 * q) as usize] as f64 / 1e3
}

fn main() {
    let mut args = std::env::args()
        .skip(1)
        .map(|a| a.parse::<u64>().expect("a number"));
    let (rounds, seconds) = (args.next().unwrap_or(6), args.next().unwrap_or(5));
    if let Err(refusal) = host::lock_memory() {
        println!("{refusal}");
    }
    host::limit_runaway();
    println!(
        "{:<6} {:>10} {:>10} {:>7} {:>10} {:>10} {:>7} {:>5}",
        "round", "plain p50", "traced", "ratio", "plain p99", "traced", "ratio", "lost"
    );
    let (mut product, mut done) = ([1.0, 1.0], 0);
    for k in 0..rounds {
        let ([mut plain, mut traced], lost) = round(seconds, k % 2 == 1);
        let [a, b, c, d] = [
            quantile(&mut plain, 0.5),
            quantile(&mut traced, 0.5),
            quantile(&mut plain, 0.99),
            quantile(&mut traced, 0.99),
        ];
        println!(
            "{k:<6} {a:>10.2} {b:>10.2} {:>7.3} {c:>10.2} {d:>10.2} {:>7.3} {lost:>5}",
            b / a,
            d / c
        );
        product = [product[0] * b / a, product[1] * d / c];
        done += 1;
    }
    let root = |p: f64| p.powf(1.0 / f64::from(done));
    println!(
        "geometric mean of the ratios, microseconds of a step: p50 {:.3}, p99 {:.3}",
        root(product[0]),
        root(product[1])
    );
}
