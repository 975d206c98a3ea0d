//! `subsumectl scale`: what a beat costs as a creature grows, hot and at its own pace, and what it weighs.
//!
//! Must never take a lucky run for the cost: each figure is the median of many, with the best beside it.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use daemon::executor::gauge::BeatGauge;
use daemon::executor::{self, Beats, Plan, Schedule, host};
use daemon::halt::HaltChannel;
use ipc::clock::{self, Span, Time};
use ipc::wire::iceoryx::Domain;
use ipc::wiring::creature::{Overrun, Wake};
use serde_json::{Value, json};

use crate::crowd;
use crate::rig::Rig;
use crate::track::histogram;

/// Arguments of `subsumectl scale`.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    subsumectl scale                  everything, half a minute\n  \
    subsumectl --json scale --cpu 0   on processor 0, for a program")]
pub struct ScaleArgs {
    /// The processor to measure on; the last one if not given
    #[arg(long, value_name = "N")]
    cpu: Option<usize>,
    /// How long each running creature is measured
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=600))]
    seconds: u64,
}

/// Numbers of modules that the line is drawn through.
const SIZES: [usize; 7] = [10, 30, 100, 300, 1_000, 3_000, 10_000];

/// Modules of a layer where there are several layers.
const EACH: usize = 10;

/// Runs of each size.
const RUNS: usize = 15;

/// Measures and prints.
pub fn command(args: &ScaleArgs, json: bool) -> ExitCode {
    let cpus = host::processors();
    let cpu = args.cpu.or(cpus.last().copied()).unwrap_or(0);
    if !cpus.contains(&cpu) {
        eprintln!("subsumectl scale: --cpu {cpu}: expected one of the processors of this process: {cpus:?}");
        return ExitCode::from(2);
    }
    host::limit_runaway();
    let measured = std::thread::spawn(move || {
        let bound = host::bind(cpu).err();
        (weigh(), line(), bound)
    });
    let Ok((weight, line, bound)) = measured.join() else {
        return ExitCode::FAILURE;
    };
    let _ = host::lock_memory();
    host::keep_off([cpu]);
    let lengths = Duration::from_secs(args.seconds);
    let paced = [(1, 10), (1, 100), (100, 10)].into_iter();
    let paced: Result<Vec<Value>, String> = paced
        .map(|(layers, each)| pace(cpu, layers, each, lengths))
        .collect();
    let measured = paced.and_then(|paced| {
        let waking = beat_at_1khz(cpu, Nothing, lengths)?;
        Ok((paced, waking, whole(cpu, 100, 10, lengths)?))
    });
    let (paced, waking, whole) = match measured {
        Ok(measured) => measured,
        Err(message) => {
            eprintln!("subsumectl scale: {message}");
            return ExitCode::FAILURE;
        }
    };
    let report = json!({
        "cpu": cpu, "bound": bound.map(|b| b.to_string()), "hot": line, "at_1khz": paced,
        "waking_at_1khz": waking, "daemon_at_1khz": whole, "memory": weight,
    });
    if json {
        println!("{report:#}");
    } else {
        print(&report);
    }
    ExitCode::SUCCESS
}

/// Median and least of what `each` says, nanoseconds.
fn median(mut each: impl FnMut() -> f64, runs: usize) -> (f64, f64) {
    let mut all: Vec<f64> = (0..runs).map(|_| each()).collect();
    all.sort_by(f64::total_cmp);
    (all[runs / 2], all[0])
}

/// How long a beat of everything takes by the number of modules, beat after beat, and the line through it.
fn line() -> Value {
    let mut points = Vec::new();
    for modules in SIZES {
        let mut rig = Rig::new(modules / EACH, EACH);
        let beats = (200_000 / modules).max(5);
        let run = || {
            let began = Instant::now();
            (0..beats).for_each(|_| rig.beat());
            began.elapsed().as_nanos() as f64 / beats as f64
        };
        let (middle, best) = median(run, RUNS);
        points.push((modules as f64, middle, best));
    }
    let (slope, offset, r2) = fit(&points.iter().map(|(x, y, _)| (*x, *y)).collect::<Vec<_>>());
    let rows: Vec<Value> = points
        .iter()
        .map(|(n, middle, best)| {
            json!({ "modules": n, "beat_ns": middle, "module_ns": middle / n, "module_best_ns": best / n })
        })
        .collect();
    json!({ "sizes": rows, "slope_ns_per_module": slope, "offset_ns": offset, "r_squared": r2 })
}

/// The straight line of least squares: slope, offset, and how much of the spread it explains.
fn fit(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let (mx, my) = points
        .iter()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| f(x - mx, y - my)).sum::<f64>();
    let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
    let slope = xy / xx;
    (slope, my - slope * mx, xy * xy / (xx * yy))
}

/// Every layer on one thread, as a group.
struct Group(Rig);

impl Beats for Group {
    fn beat(&mut self, now: Time) {
        self.0.layers.iter_mut().for_each(|layer| layer.step(now));
        let stamp = clock::monotonic();
        // As the daemon does: what was stepped last is at hand still.
        self.0
            .layers
            .iter_mut()
            .rev()
            .for_each(|layer| layer.commit(stamp));
    }
}

/// Nothing to do but to wake.
struct Nothing;

impl Beats for Nothing {
    fn beat(&mut self, _: Time) {}
}

/// A creature at 1 kHz, its wires in shared memory: what share of a processor it takes, how long a beat is.
fn pace(cpu: usize, layers: usize, each: usize, length: Duration) -> Result<Value, String> {
    let modules = layers * each;
    let name = format!("scale{}", std::process::id());
    let domain = Domain::join(&name).map_err(|e| e.to_string())?;
    let owned = domain.own(&name, 2 * modules).map_err(|e| e.to_string())?;
    let rig = Rig::on(owned.page(), layers, each);
    let mut paced = beat_at_1khz(cpu, Group(rig), length)?;
    drop(owned);
    domain.leave();
    for (key, count) in [("layers", layers), ("modules", modules), ("wires", 2 * modules)] {
        paced[key] = json!(count);
    }
    for (key, of) in [("module_p50_ns", "beat_p50_ns"), ("module_p10_ns", "beat_p10_ns")] {
        paced[key] = json!(paced[of].as_f64().unwrap_or(0.0) / modules as f64);
    }
    Ok(paced)
}

/// A thread that beats at 1 kHz: what share of a processor it takes, and what share its beats do without the waking.
fn beat_at_1khz(cpu: usize, beats: impl Beats, length: Duration) -> Result<Value, String> {
    let plan = Plan {
        name: "group".into(),
        period: Span::millis(1),
        phase: Span::ZERO,
        schedule: Schedule::Fifo(70),
        cpu: Some(cpu),
        wake: Wake::Sleep,
        overrun: Overrun::Skip,
        sealed: true,
    };
    let (gauge, stop) = (Arc::new(BeatGauge::default()), Arc::new(AtomicBool::new(false)));
    let begin = (clock::monotonic() + Span::millis(20)).off_tick();
    let halt = Arc::new(HaltChannel::default());
    let mut thread = executor::start(plan, begin, beats, vec![gauge.clone()], halt, stop.clone())
        .map_err(|e| e.to_string())?;
    std::thread::sleep(Duration::from_millis(200));
    let refusals: Vec<String> = thread.refusals.iter().map(ToString::to_string).collect();
    while thread.samples[0].pop().is_ok() {}
    let (ran, beats, began) = (ran(thread.tid), gauge.counts().beats, Instant::now());
    let (mut step, mut in_beats) = (histogram(), Span::ZERO);
    while began.elapsed() < length {
        std::thread::sleep(Duration::from_millis(100));
        while let Ok(sample) = thread.samples[0].pop() {
            step.saturating_record(sample.step.0.max(1));
            in_beats = in_beats + sample.step;
        }
    }
    let (ran, passed) = (self::ran(thread.tid) - ran, began.elapsed().as_nanos() as f64);
    let counts = gauge.counts();
    stop.store(true, Ordering::Relaxed);
    thread.join();
    Ok(json!({
        "beats": counts.beats - beats, "missed": counts.missed,
        "processor_share": ran as f64 / passed, "beats_share": in_beats.0 as f64 / passed,
        "beat_p10_ns": step.value_at_quantile(0.1), "beat_p50_ns": step.value_at_quantile(0.5),
        "beat_p99_ns": step.value_at_quantile(0.99), "refusals": refusals,
    }))
}

/// A whole daemon with a creature of such modules, but without suppressors: what share of a processor its group's thread takes, and what its other threads do.
fn whole(cpu: usize, layers: usize, each: usize, length: Duration) -> Result<Value, String> {
    let running = crowd::start(cpu, layers, each)?;
    std::thread::sleep(Duration::from_millis(500));
    let group = running.threads().first().map_or(0, |(_, tid)| *tid);
    let (thread, process, began) = (ran(group), ran_in_all(), Instant::now());
    std::thread::sleep(length);
    let passed = began.elapsed().as_nanos() as f64;
    let (thread, process) = (ran(group) - thread, ran_in_all() - process);
    let records = running.records.lock().expect("nobody panics holding the records");
    let counts = records[0].gauge.counts();
    drop(records);
    let refusals: Vec<String> = running.refusals.iter().map(ToString::to_string).collect();
    running.shut_down();
    Ok(json!({
        "layers": layers, "modules": layers * each, "wires": 2 * layers * each, "processor_share": thread as f64 / passed,
        "other_threads_share": process.saturating_sub(thread) as f64 / passed,
        "beats": counts.beats, "missed": counts.missed, "refusals": refusals,
    }))
}

/// Nanoseconds that all threads of this process have run.
fn ran_in_all() -> u64 {
    let threads = std::fs::read_dir("/proc/self/task")
        .into_iter()
        .flatten()
        .flatten();
    let tids = threads.filter_map(|t| t.file_name().to_str()?.parse().ok());
    tids.map(ran).sum()
}

/// Nanoseconds that a thread of this process has run.
fn ran(tid: i32) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/self/task/{tid}/schedstat")).unwrap_or_default();
    text.split_whitespace()
        .next()
        .and_then(|w| w.parse().ok())
        .unwrap_or(0)
}

/// What a module and a wire weigh, by what the process grows when there are ten thousand.
fn weigh() -> Value {
    let modules = 10_000;
    let before = resident();
    let rig = Rig::new(modules / EACH, EACH);
    let grown = resident().saturating_sub(before);
    let wires = 2 * modules as u64;
    drop(rig);
    json!({
        "wire_bytes": CELL_BYTES,
        "module_bytes": grown.saturating_sub(wires * CELL_BYTES) / modules as u64,
        "what": "a module of two inputs, a reset line, an output and a suppressor; room for taps included",
    })
}

/// A wire's cell in shared memory.
const CELL_BYTES: u64 = 128;

/// Bytes of this process that are in memory.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text
        .split_whitespace()
        .nth(1)
        .and_then(|w| w.parse::<u64>().ok())
        .unwrap_or(0);
    pages * rustix::param::page_size() as u64
}

fn print(report: &Value) {
    println!("A module: two inputs with a new message each beat, one output, one suppressor.\n");
    println!("| modules | beat, µs | a module, ns | best, ns |\n|---:|---:|---:|---:|");
    for row in report["hot"]["sizes"].as_array().into_iter().flatten() {
        let f = |key: &str| row[key].as_f64().unwrap_or(0.0);
        println!(
            "| {} | {:.2} | {:.1} | {:.1} |",
            f("modules"),
            f("beat_ns") / 1e3,
            f("module_ns"),
            f("module_best_ns")
        );
    }
    let hot = |key: &str| report["hot"][key].as_f64().unwrap_or(0.0);
    println!(
        "\nline: {:.1} ns a module + {:.0} ns, R² {:.4}\n",
        hot("slope_ns_per_module"),
        hot("offset_ns"),
        hot("r_squared")
    );
    println!(
        "| at 1 kHz | wires | share of a processor | of it in beats | beat p50, µs | p99, µs | a module, ns |\n|---|---:|---:|---:|---:|---:|---:|"
    );
    println!(
        "| nothing: only waking | 0 | {:.2} % | | | | |",
        100.0
            * report["waking_at_1khz"]["processor_share"]
                .as_f64()
                .unwrap_or(0.0)
    );
    for row in report["at_1khz"].as_array().into_iter().flatten() {
        let f = |key: &str| row[key].as_f64().unwrap_or(0.0);
        println!(
            "| {} modules in {} layers | {} | {:.2} % | {:.2} % | {:.2} | {:.2} | {:.1} |",
            f("modules"),
            f("layers"),
            f("wires"),
            100.0 * f("processor_share"),
            100.0 * f("beats_share"),
            f("beat_p50_ns") / 1e3,
            f("beat_p99_ns") / 1e3,
            f("module_p50_ns")
        );
    }
    let whole = |key: &str| report["daemon_at_1khz"][key].as_f64().unwrap_or(0.0);
    println!(
        "\nin a whole daemon, traced and measured: {} modules without suppressors in {} layers of one group on {} wires take {:.2} % in the group's \
         thread, {:.2} % in the ordinary threads beside it",
        whole("modules"),
        whole("layers"),
        whole("wires"),
        100.0 * whole("processor_share"),
        100.0 * whole("other_threads_share")
    );
    println!(
        "\nmemory: {} bytes a wire, {} bytes a module ({})",
        report["memory"]["wire_bytes"],
        report["memory"]["module_bytes"],
        report["memory"]["what"].as_str().unwrap_or_default()
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_through_points_on_it() {
        let (slope, offset, r2) = fit(&[(10.0, 205.0), (100.0, 2005.0), (1000.0, 20_005.0)]);
        assert!((slope - 20.0).abs() < 1e-9 && (offset - 5.0).abs() < 1e-6 && (r2 - 1.0).abs() < 1e-12);
        let (_, _, r2) = fit(&[(1.0, 1.0), (2.0, 4.0), (3.0, 1.0)]);
        assert!(r2 < 0.1);
    }
}
