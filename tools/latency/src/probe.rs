//! Probes: threads of the executor with a small layer on them, beside whom others can be measured.
//!
//! Must never run without an end: the executor bounds what a runaway may take, and a probe is stopped when it
//! is dropped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use daemon::executor::gauge::{BeatCounts, BeatGauge, Sample};
use daemon::executor::{self, Beating, Beats, Plan, Refusal};
use daemon::halt::HaltChannel;
use ipc::clock::{self, Time};

use crate::plant::{Plant, Planted};
use crate::rig::Rig;

/// Modules of a probe's layer: a small layer of a small creature.
const MODULES: usize = 10;

/// A layer of ten modules on a page in memory, and what is planted in it.
struct Small {
    rig: Rig,
    planted: Planted,
}

impl Beats for Small {
    fn beat(&mut self, now: Time) {
        for layer in &mut self.rig.layers {
            layer.step(now);
            layer.commit(clock::monotonic());
        }
        self.planted.step();
    }
}

/// A thread that beats.
pub struct Probe {
    beating: Option<Beating>,
    gauge: Arc<BeatGauge>,
    stop: Arc<AtomicBool>,
    seen: Vec<Sample>,
    before: Host,
}

/// What the host counted of a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Host {
    /// Page faults, minor and major.
    pub faults: u64,
    /// How often it gave the processor away: once a beat.
    pub sleeps: u64,
}

/// What a probe was seen to do.
pub struct Seen {
    /// Every beat.
    pub samples: Vec<Sample>,
    /// What it counted.
    pub counts: BeatCounts,
    /// What the host counted while it beat.
    pub host: Host,
}

impl Host {
    /// The host's counters of a thread of this process.
    pub fn of(tid: i32) -> Host {
        let read =
            |file: &str| std::fs::read_to_string(format!("/proc/self/task/{tid}/{file}")).unwrap_or_default();
        let stat = read("stat");
        // After the name, which may hold anything: minflt is the 8th field, majflt the 10th.
        let fields: Vec<u64> = stat
            .rsplit(')')
            .next()
            .unwrap_or_default()
            .split_whitespace()
            .map(|w| w.parse().unwrap_or(0))
            .collect();
        let fault = |n: usize| fields.get(n).copied().unwrap_or(0);
        let status = read("status");
        let sleeps = status
            .lines()
            .find_map(|l| l.strip_prefix("voluntary_ctxt_switches:"));
        Host {
            faults: fault(7) + fault(9),
            sleeps: sleeps.and_then(|s| s.trim().parse().ok()).unwrap_or(0),
        }
    }
}

impl Probe {
    /// Starts a probe whose first beat is due at `begin` and its phase.
    ///
    /// # Errors
    /// When the host refuses the thread.
    pub fn start(plan: Plan, begin: Time, plant: Option<Plant>) -> std::io::Result<Probe> {
        let (gauge, stop) = (Arc::new(BeatGauge::default()), Arc::new(AtomicBool::new(false)));
        let halt = Arc::new(HaltChannel::default());
        let small = Small {
            rig: Rig::new(1, MODULES),
            planted: Planted::new(plant),
        };
        let beating = executor::start(plan, begin, small, vec![gauge.clone()], halt, stop.clone())?;
        Ok(Probe {
            beating: Some(beating),
            gauge,
            stop,
            seen: Vec::new(),
            before: Host::default(),
        })
    }

    /// Its kernel thread id.
    pub fn tid(&self) -> i32 {
        self.beating.as_ref().map_or(0, |b| b.tid)
    }

    /// From now on what the host counts is held against it: to be called once it beats.
    pub fn watch(&mut self) {
        self.before = Host::of(self.tid());
    }

    /// What the host refused it.
    pub fn refusals(&self) -> &[Refusal] {
        self.beating.as_ref().map_or(&[], |b| &b.refusals)
    }

    /// Takes in what was sampled; to be called several times a second.
    pub fn drain(&mut self) {
        if let Some(beating) = &mut self.beating {
            for ring in &mut beating.samples {
                while let Ok(sample) = ring.pop() {
                    self.seen.push(sample);
                }
            }
        }
    }

    /// Stops it; what it was seen to do.
    pub fn finish(mut self) -> Seen {
        let now = Host::of(self.tid());
        self.stop.store(true, Ordering::Relaxed);
        self.drain();
        if let Some(beating) = self.beating.take() {
            beating.join();
        }
        Seen {
            samples: std::mem::take(&mut self.seen),
            counts: self.gauge.counts(),
            host: Host {
                faults: now.faults - self.before.faults,
                sleeps: now.sleeps - self.before.sleeps,
            },
        }
    }
}

impl Drop for Probe {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(beating) = self.beating.take() {
            beating.join();
        }
    }
}
