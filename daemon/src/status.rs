//! Status: everything that can be seen of a running creature, gathered ten times a second.
//!
//! Must never touch a real-time thread: it reads cells, counters and sample rings like anybody else.

use std::collections::{HashMap, VecDeque};

use hdrhistogram::Histogram;
use ipc::clock::{self, Span, Time};
use ipc::message::Kind;
use ipc::tap::Window;
use ipc::wire::{AHEAD_MAX, Reader, TapGauge};
use ipc::wiring::creature::{How, Wake};
use rtrb::Consumer;
use serde_json::{Value, json};
use std::sync::Arc;

use crate::executor::Plan;
use crate::executor::gauge::{BeatCounts, BeatGauge, Sample};
use crate::plugs::Attached;

/// Longest latency that is told apart; longer ones count as this.
const LATENCY_MAX_NS: u64 = 10_000_000_000;

/// Histograms of one layer, in nanoseconds; `docs/timing.md` says what each number means.
#[derive(Clone, Debug)]
pub struct Measured {
    /// From the moment a beat was due to the moment its thread ran.
    pub wake_up: Histogram<u64>,
    /// How long a beat of the layer took.
    pub step: Histogram<u64>,
    /// From the moment a beat was due to its end.
    pub response: Histogram<u64>,
    /// By how much the time between two wake-ups differed from the time between their beats.
    pub period_error: Histogram<u64>,
}

/// Histograms of what one thread measured.
pub struct Record {
    /// The thread's layer.
    pub name: String,
    /// Its level; none for the motor unit.
    pub level: Option<u8>,
    /// How its thread beats.
    pub plan: Plan,
    /// Its counters.
    pub gauge: Arc<BeatGauge>,
    samples: Consumer<Sample>,
    latency: Histogram<u64>,
    step: Histogram<u64>,
    response: Histogram<u64>,
    period_error: Histogram<u64>,
    /// When the thread woke for the beat before; none before the first.
    woke: Option<(Time, Time)>,
    /// Who it tells of when a deadline is missed; nobody if another member of its group does.
    teller: Option<String>,
    /// Counters at the last look, to notice what is new.
    before: BeatCounts,
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
        plan: &Plan,
        gauge: Arc<BeatGauge>,
        samples: Consumer<Sample>,
    ) -> Self {
        let histogram = || Histogram::new_with_bounds(1, LATENCY_MAX_NS, 3).expect("bounds are sound");
        Record {
            name: name.into(),
            level,
            plan: plan.clone(),
            gauge,
            samples,
            latency: histogram(),
            step: histogram(),
            response: histogram(),
            period_error: histogram(),
            woke: None,
            teller: Some(name.into()),
            before: BeatCounts::default(),
            trail: VecDeque::new(),
            longest: (0.0, 0),
        }
    }

    /// Its thread has several members, which miss the same deadlines: it tells of them as `teller`, or leaves that to
    /// another.
    #[must_use]
    pub fn telling(self, teller: Option<String>) -> Record {
        Record { teller, ..self }
    }

    /// Takes in what was measured since the last look; says in words what deadlines were missed.
    pub fn drain(&mut self) -> Option<String> {
        while let Ok(sample) = self.samples.pop() {
            self.latency.saturating_record(sample.latency.0.max(1));
            self.step.saturating_record(sample.step.0.max(1));
            self.longest.0 = self.longest.0.max(sample.latency.0 as f64 / 1e3);
            self.response.saturating_record(sample.response.0.max(1));
            let woke = sample.due + sample.latency;
            if let Some((due, before)) = self.woke.replace((sample.due, woke)) {
                let error = sample.due.since(due).0.abs_diff(woke.since(before).0);
                self.period_error.saturating_record(error.max(1));
            }
        }
        self.keep_trail();
        let now = self.gauge.counts();
        let before = std::mem::replace(&mut self.before, now);
        let teller = self.teller.as_ref()?;
        if now.identity_faults > before.identity_faults {
            return Some(format!(
                "{teller}: beats and skipped beats do not add up to the time elapsed"
            ));
        }
        let (missed, over) = (now.missed - before.missed, now.overruns - before.overruns);
        (missed + over > 0).then(|| {
            format!(
                "{teller} missed {missed} deadlines ({over} of its own making, {} skipped; {} of {} beats so far, at most {} in a row)",
                now.skipped - before.skipped,
                now.missed,
                now.beats,
                now.missed_in_row_max
            )
        })
    }

    /// Keeps the longest latency of each second.
    fn keep_trail(&mut self) {
        self.longest.1 += 1;
        if self.longest.1 == LOOKS {
            if self.trail.len() == TRAIL_MAX {
                self.trail.pop_front();
            }
            self.trail.push_back(self.longest.0);
            self.longest = (0.0, 0);
        }
    }

    /// Everything measured so far.
    pub fn measured(&self) -> Measured {
        Measured {
            wake_up: self.latency.clone(),
            step: self.step.clone(),
            response: self.response.clone(),
            period_error: self.period_error.clone(),
        }
    }

    fn show(&self) -> Value {
        let counts = self.gauge.counts();
        json!({
            "name": self.name, "level": self.level, "period_ms": self.plan.period.as_millis_f64(),
            "schedule": self.plan.schedule.to_string(), "wake": wake(self.plan.wake), "cpu": self.plan.cpu,
            "thread": self.plan.name,
            "beats": counts.beats, "skipped": counts.skipped, "overruns": counts.overruns,
            "missed": counts.missed, "missed_in_row_max": counts.missed_in_row_max,
            "identity_faults": counts.identity_faults, "lost_samples": counts.lost_samples, "attached": false,
            "latency_us": percentiles(&self.latency), "step_us": percentiles(&self.step),
            "response_us": percentiles(&self.response), "period_error_us": percentiles(&self.period_error),
            "histogram": bars(&self.latency), "step_histogram": bars(&self.step),
            "latency_sum_us": sum(&self.latency), "step_sum_us": sum(&self.step), "trail_us": self.trail,
        })
    }
}

/// How a thread waits for its beat, in words.
fn wake(wake: Wake) -> String {
    match wake {
        Wake::Sleep => "sleep".into(),
        Wake::Spin(lead) => format!("spin {lead}"),
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
    /// Forgets wires that are no longer there, so that layers that come under ever new names leave nothing.
    pub fn keep_only(&mut self, wires: &[Value]) {
        let names: std::collections::HashSet<&str> =
            wires.iter().filter_map(|w| w["wire"].as_str()).collect();
        self.seen.retain(|name, _| names.contains(name.as_str()));
    }

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
    /// The attached layer at whose port it acts; none for one of the daemon's own.
    pub at: Option<String>,
    /// Whether it stands there, or waits for that layer.
    pub joined: bool,
}

/// The window that a tap's newest message opened, over or not; none while it stands nowhere or is silent.
pub fn window(t: &WatchedTap, now: Time) -> Option<Window> {
    // What is stamped in the future is no message: see the register.
    let reading = t.reader.read().filter(|r| t.joined && r.stamp <= now + AHEAD_MAX);
    reading.map(|r| Window {
        stamp: r.stamp.min(now),
        time_constant: t.time_constant,
    })
}

/// Shows a tap: whether it holds, and for how long still.
pub fn tap(t: &WatchedTap, now: Time) -> Value {
    let remaining = window(t, now).map_or(Span::ZERO, |w| w.remaining(now));
    let counts = t.gauge.counts();
    json!({
        "from": t.from, "to": t.to, "kind": t.how, "layer": t.layer.0, "level": t.layer.1, "time_constant_ms": t.time_constant.as_millis_f64(),
        "holds": remaining > Span::ZERO, "remaining_ms": remaining.as_millis_f64(),
        "delivered": counts.delivered, "rejected": counts.rejected, "faults": counts.faults,
        "at": t.at, "joined": t.joined,
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

#[cfg(test)]
mod tests {
    use ipc::clock::Span;
    use ipc::wiring::creature::Overrun;

    use super::*;
    use crate::executor::Schedule;
    use crate::executor::deadline::Verdict;

    #[test]
    fn one_layer_tells_of_the_deadlines_that_its_group_missed() {
        let plan = Plan {
            name: "low".into(),
            period: Span::millis(1),
            phase: Span::ZERO,
            schedule: Schedule::Fifo(79),
            cpu: None,
            wake: Wake::Sleep,
            overrun: Overrun::Skip,
            sealed: true,
        };
        let record = |name| {
            let (_, samples) = rtrb::RingBuffer::new(1);
            Record::new(name, Some(0), &plan, Arc::default(), samples)
        };
        let mut records = [
            record("alone"),
            record("first").telling(Some("the group low (2 layers)".into())),
            record("second").telling(None),
        ];
        let missed = Verdict {
            missed: true,
            ..Verdict::default()
        };
        let told = records.each_mut().map(|record| {
            record.gauge.judged(Time(1), missed, true);
            record.drain()
        });
        assert!(
            told[0]
                .as_deref()
                .is_some_and(|t| t.starts_with("alone missed 1 deadlines"))
        );
        assert!(
            told[1]
                .as_deref()
                .is_some_and(|t| t.starts_with("the group low (2 layers) missed 1 deadlines"))
        );
        assert_eq!(told[2], None);
    }
}
