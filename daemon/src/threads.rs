//! Threads: a machine's layers and motor unit, put on real-time threads as planned.
//!
//! Must never decide anything about time: the plan does, the executor keeps it. Layers that share a thread all
//! look before any of them writes, and the highest level writes first, as on the virtual clock; so a group
//! behaves like its layers on threads of their own that happen to beat at the same moment.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use afsm::layer::RunningLayer;
use afsm::trace::trace;
use ipc::clock::{self, Span, Time};
use ipc::wiring::creature::{PRIORITY_MAX, Policy};
use rtrb::Consumer;

use crate::executor::gauge::{BeatGauge, Sample};
use crate::executor::plan::{self, Plan};
use crate::executor::{self, Beating, Beats, Refusal};
use crate::halt::HaltChannel;
use crate::machine::Station;
use crate::motor::Motor;
use crate::recorder::Feed;
use crate::status::Record;
use crate::watchdog::Watchdog;

/// The layers of one thread, lowest level first.
struct LayerBeats {
    layers: Vec<RunningLayer>,
    took: Vec<Span>,
}

impl Beats for LayerBeats {
    fn beat(&mut self, now: Time) {
        let mut before = now;
        for (layer, took) in self.layers.iter_mut().zip(&mut self.took) {
            layer.step(now);
            let after = clock::monotonic();
            *took = after.since(before);
            before = after;
        }
        let stamp = before;
        if let [only] = &mut self.layers[..] {
            only.commit(stamp);
            return;
        }
        for (layer, took) in self.layers.iter_mut().zip(&mut self.took).rev() {
            layer.commit(stamp);
            let after = clock::monotonic();
            *took = *took + after.since(before);
            before = after;
        }
    }

    fn took(&self, member: usize) -> Option<Span> {
        (self.took.len() > 1).then(|| self.took[member])
    }
}

struct MotorBeats(Motor);

impl Beats for MotorBeats {
    fn beat(&mut self, now: Time) {
        self.0.gather(now);
        self.0.act(clock::monotonic());
    }
}

struct WatchdogBeats(Watchdog);

impl Beats for WatchdogBeats {
    fn beat(&mut self, now: Time) {
        self.0.look(now);
    }
}

/// Priority of the watchdog: above every layer whatever its file says (at most 97), below the kernel's own
/// threads at 99.
const PRIORITY_WATCHDOG: u8 = 98;

/// What every thread is started with.
pub struct Start {
    /// Every grid begins here.
    pub begin: Time,
    /// The halt channel.
    pub halt: Arc<HaltChannel>,
    /// Ends them all.
    pub stop: Arc<AtomicBool>,
    /// The scheduler that the creature asks for.
    pub policy: Policy,
    /// How many threads the layers have.
    pub threads: usize,
}

/// The real-time threads as they are started.
pub struct Crew {
    /// The threads.
    pub beating: Vec<Beating>,
    /// Where each layer, the watchdog and the motor unit are measured; layers first, in the creature's order.
    pub records: Vec<Record>,
    /// What each layer and the motor unit trace, in that order.
    pub feeds: Vec<Feed>,
    /// What the host refused.
    pub refusals: Vec<Refusal>,
    start: Start,
}

impl Crew {
    /// Nobody yet.
    pub fn new(start: Start) -> Crew {
        Crew {
            beating: Vec::new(),
            records: Vec::new(),
            feeds: Vec::new(),
            refusals: Vec::new(),
            start,
        }
    }

    /// Starts the threads of `shared` for `stations`, which are the layers in the creature's order.
    ///
    /// # Errors
    /// When the host refuses a thread.
    pub fn start_layers(&mut self, shared: Vec<plan::Shared>, stations: Vec<Station>) -> io::Result<()> {
        let mut stations: Vec<Option<Station>> = stations.into_iter().map(Some).collect();
        let mut records: Vec<(usize, Record)> = Vec::new();
        let mut feeds: Vec<(usize, Feed)> = Vec::new();
        for plan::Shared { plan, layers } in shared {
            let (mut running, mut gauges, mut specs) = (Vec::new(), Vec::new(), Vec::new());
            for &index in &layers {
                let mut station = stations[index].take().expect("a layer is on one thread");
                let (registers, outlets) = station.running.ports();
                let (tracer, trace) = trace(station.spec.period, registers, outlets);
                station.running.trace(tracer);
                feeds.push((index, Feed::new(trace, station.gauge.clone())));
                running.push(station.running);
                gauges.push(station.gauge);
                specs.push(station.spec);
            }
            let took = vec![Span::ZERO; running.len()];
            let beats = LayerBeats {
                layers: running,
                took,
            };
            let samples = self.beat(plan.clone(), beats, gauges.clone())?;
            let members = specs.len();
            for (((index, spec), gauge), samples) in layers.into_iter().zip(&specs).zip(gauges).zip(samples) {
                let mut record = Record::new(&spec.name, Some(spec.level), &plan, gauge, samples);
                if members > 1 {
                    let group = || format!("the group {} ({members} layers)", plan.name);
                    let first = spec.name == specs[0].name;
                    record = record.telling(first.then(group));
                }
                records.push((index, record));
            }
        }
        records.sort_by_key(|(index, _)| *index);
        self.records.extend(records.into_iter().map(|(_, record)| record));
        feeds.sort_by_key(|(index, _)| *index);
        self.feeds.extend(feeds.into_iter().map(|(_, feed)| feed));
        Ok(())
    }

    /// Starts the motor unit's thread.
    ///
    /// # Errors
    /// When the host refuses the thread.
    pub fn start_motor(&mut self, mut motor: Motor, gauge: Arc<BeatGauge>) -> io::Result<()> {
        let period = motor.period();
        let (inputs, sensors) = motor.ports();
        let (tracer, trace) = trace(period, inputs, sensors);
        motor.trace(tracer);
        self.feeds.push(Feed::new(trace, gauge.clone()));
        self.own("motor", period, PRIORITY_MAX, MotorBeats(motor), gauge)
    }

    /// Starts the watchdog's thread, which looks every `period`.
    ///
    /// # Errors
    /// When the host refuses the thread.
    pub fn start_watchdog(&mut self, watchdog: Watchdog, period: Span) -> io::Result<()> {
        let gauge = self.start.halt.watchdog.clone();
        self.own(
            "watchdog",
            period,
            PRIORITY_WATCHDOG,
            WatchdogBeats(watchdog),
            gauge,
        )
    }

    /// Starts a thread that belongs to no layer.
    fn own(
        &mut self,
        name: &str,
        period: Span,
        priority: u8,
        beats: impl Beats,
        gauge: Arc<BeatGauge>,
    ) -> io::Result<()> {
        let plan = plan::own(name, period, priority, self.start.policy, self.start.threads);
        let mut samples = self.beat(plan.clone(), beats, vec![gauge.clone()])?;
        let samples = samples.pop().expect("a thread has samples of each member");
        self.records.push(Record::new(name, None, &plan, gauge, samples));
        Ok(())
    }

    fn beat(
        &mut self,
        plan: Plan,
        beats: impl Beats,
        gauges: Vec<Arc<BeatGauge>>,
    ) -> io::Result<Vec<Consumer<Sample>>> {
        let (halt, stop) = (self.start.halt.clone(), self.start.stop.clone());
        let mut thread = executor::start(plan, self.start.begin, beats, gauges, halt, stop)?;
        for refusal in std::mem::take(&mut thread.refusals) {
            if !self.refusals.iter().any(|r| r.grants == refusal.grants) {
                self.refusals.push(refusal);
            }
        }
        let samples = std::mem::take(&mut thread.samples);
        self.beating.push(thread);
        Ok(samples)
    }
}
