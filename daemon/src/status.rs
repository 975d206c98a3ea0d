//! Status: everything that can be seen of a running creature, gathered ten times a second.
//!
//! Must never touch a real-time thread: it reads cells, counters and sample rings like anybody else.

use std::collections::{HashMap, VecDeque};

use hdrhistogram::Histogram;
use ipc::clock::{self, Span, Time};
use ipc::message::Kind;
use ipc::tap::Window;
use ipc::wire::{Reader, TapGauge};
use ipc::wiring::creature::How;
use rtrb::Consumer;
use serde_json::{Value, json};
use std::sync::Arc;

use crate::executor::gauge::{BeatGauge, Sample};
use crate::plugs::Attached;

/// Longest latency that is told apart; longer ones count as this.
const LATENCY_MAX_NS: u64 = 10_000_000_000;

/// Histograms of what one thread measured.
pub struct Record {
    /// The thread's layer.
    pub name: String,
    /// Its level; none for the motor unit.
    pub level: Option<u8>,
    /// Time between its beats.
    pub period: Span,
    /// Its counters.
    pub gauge: Arc<BeatGauge>,
    samples: Consumer<Sample>,
    latency: Histogram<u64>,
    step: Histogram<u64>,
    /// Overruns at the last look, to notice new ones.
    overruns: u64,
    /// Longest latency of each of the last seconds, oldest first, in microseconds.
    trail: VecDeque<f64>,
    /// Longest latency since the last second ended, and how many looks ago that was.
    longest: (f64, u32),
}

/// How many seconds back the trail of latencies goes.
const TRAIL_MAX: usize = 60;

/// Looks of the watcher in a second.
const LOOKS: u32 = 10;

impl Record {
    /// An empty record of the thread whose samples these are.
    pub fn new(
        name: &str,
        level: Option<u8>,
        period: Span,
        gauge: Arc<BeatGauge>,
        samples: Consumer<Sample>,
    ) -> Self {
        let histogram = || Histogram::new_with_bounds(1, LATENCY_MAX_NS, 3).expect("bounds are sound");
        Record {
            name: name.into(),
            level,
            period,
            gauge,
            samples,
            latency: histogram(),
            step: histogram(),
            overruns: 0,
            trail: VecDeque::new(),
            longest: (0.0, 0),
        }
    }

    /// Takes in what was measured since the last look; says how many overruns are new.
    pub fn drain(&mut self) -> u64 {
        while let Ok(sample) = self.samples.pop() {
            self.latency.saturating_record(sample.latency.0.max(1));
            self.step.saturating_record(sample.step.0.max(1));
            self.longest.0 = self.longest.0.max(sample.latency.0 as f64 / 1e3);
        }
        self.longest.1 += 1;
        if self.longest.1 == LOOKS {
            if self.trail.len() == TRAIL_MAX {
                self.trail.pop_front();
            }
            self.trail.push_back(self.longest.0);
            self.longest = (0.0, 0);
        }
        let overruns = self.gauge.counts().overruns;
        let new = overruns - self.overruns;
        self.overruns = overruns;
        new
    }

    fn show(&self) -> Value {
        let counts = self.gauge.counts();
        json!({
            "name": self.name, "level": self.level, "period_ms": self.period.as_millis_f64(),
            "beats": counts.beats, "skipped": counts.skipped, "overruns": counts.overruns,
            "lost_samples": counts.lost_samples, "attached": false,
            "latency_us": percentiles(&self.latency), "step_us": percentiles(&self.step),
            "histogram": bars(&self.latency), "step_histogram": bars(&self.step),
            "latency_sum_us": sum(&self.latency), "step_sum_us": sum(&self.step), "trail_us": self.trail,
        })
    }
}

fn percentiles(h: &Histogram<u64>) -> Value {
    let us = |q: f64| h.value_at_quantile(q) as f64 / 1e3;
    json!({ "p50": us(0.5), "p99": us(0.99), "p999": us(0.999), "max": h.max() as f64 / 1e3 })
}

/// Sum of everything in a histogram, in microseconds.
fn sum(h: &Histogram<u64>) -> f64 {
    h.mean() * h.len() as f64 / 1e3
}

/// Bars of a histogram: upper bound in microseconds, doubling from 1, and count.
fn bars(h: &Histogram<u64>) -> Vec<(f64, u64)> {
    let mut bars = Vec::new();
    let mut low = 0;
    let mut high = 1_000;
    while low <= h.max() && bars.len() < 40 {
        bars.push((high as f64 / 1e3, h.count_between(low, high - 1)));
        low = high;
        high *= 2;
    }
    bars
}

/// A wire as it is watched.
pub struct Watched {
    /// `module.port`.
    pub name: String,
    /// Its unit, or empty.
    pub unit: String,
    /// Its newest message.
    pub reader: Reader,
}

/// The rate of each wire, from two looks.
#[derive(Default)]
pub struct Rates {
    seen: HashMap<String, (u64, Time, f64)>,
}

impl Rates {
    fn of(&mut self, name: &str, number: u64, now: Time) -> f64 {
        let (before, at, rate) = self.seen.entry(name.into()).or_insert((number, now, 0.0));
        if number < *before {
            // A layer of that name came back: its wires count from the beginning.
            (*before, *at) = (number, now);
        }
        let passed = now.since(*at).seconds();
        if passed >= 1.0 {
            *rate = (number - *before) as f64 / passed;
            (*before, *at) = (number, now);
        }
        *rate
    }
}

/// Shows a wire.
pub fn wire(w: &Watched, rates: &mut Rates, now: Time) -> Value {
    let reading = w.reader.read();
    let kind = w.reader.kind();
    let value = reading.map_or(Value::Null, |r| value(kind, &r.words));
    let number = reading.map_or(0, |r| r.number);
    json!({
        "wire": w.name, "type": kind.name(), "unit": w.unit, "value": value,
        "age_ms": reading.map(|r| now.since(r.stamp).as_millis_f64()),
        "messages": number, "rate_hz": rates.of(&w.name, number, now),
    })
}

/// A message as JSON: a number, true or false, or a list of numbers.
pub fn value(kind: Kind, words: &ipc::message::Words) -> Value {
    match kind {
        Kind::Pulse => json!(true),
        Kind::Bit => json!(words[0] != 0.0),
        Kind::Number => json!(words[0]),
        _ => json!(words[..kind.words()]),
    }
}

/// A tap as it is watched.
pub struct WatchedTap {
    /// Which way it acts.
    pub how: How,
    /// Where its messages come from.
    pub from: String,
    /// Where it acts.
    pub to: String,
    /// Its time constant.
    pub time_constant: Span,
    /// Its layer and that layer's level.
    pub layer: (String, u8),
    /// Its messages.
    pub reader: Reader,
    /// Its counters.
    pub gauge: Arc<TapGauge>,
}

/// Shows a tap: whether it holds, and for how long still.
pub fn tap(t: &WatchedTap, now: Time) -> Value {
    let window = t.reader.read().map(|r| Window {
        stamp: r.stamp.min(now),
        time_constant: t.time_constant,
    });
    let remaining = window.map_or(Span::ZERO, |w| w.remaining(now));
    let counts = t.gauge.counts();
    json!({
        "from": t.from, "to": t.to, "kind": t.how, "layer": t.layer.0, "level": t.layer.1, "time_constant_ms": t.time_constant.as_millis_f64(),
        "holds": remaining > Span::ZERO, "remaining_ms": remaining.as_millis_f64(),
        "delivered": counts.delivered, "rejected": counts.rejected, "faults": counts.faults,
    })
}

/// Shows an attached layer.
pub fn attached(a: &Attached) -> Value {
    json!({
        "name": a.plug.layer, "level": a.plug.level, "period_ms": a.plug.period.as_millis_f64(),
        "pid": a.plug.pid, "attached": true,
    })
}

/// Shows the threads of the daemon.
pub fn layers(records: &[Record]) -> Vec<Value> {
    records.iter().map(Record::show).collect()
}

/// The time now, for those who show things.
pub fn now() -> Time {
    clock::monotonic()
}
