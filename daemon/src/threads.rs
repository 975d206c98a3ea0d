//! Threads: a machine's layers and motor unit, put on real-time threads as planned.
//!
//! Must never decide anything about time: the plan does, the executor keeps it. Layers that share a thread all
//! look before any of them writes, and the highest level writes first, as on the virtual clock; so a group
//! behaves like its layers on threads of their own that happen to beat at the same moment.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use afsm::layer::RunningLayer;
use ipc::clock::{self, Span, Time};

use crate::executor::gauge::BeatGauge;
use crate::executor::plan::{self, Plan};
use crate::executor::{self, Beating, Beats, Refusal};
use crate::machine::Station;
use crate::motor::{HaltChannel, Motor};
use crate::status::Record;

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

/// What beats, what they record, what the host refused them.
#[derive(Default)]
pub struct Crew {
    /// The threads.
    pub beating: Vec<Beating>,
    /// Where each layer, and the motor unit, is measured; layers in the creature's order.
    pub records: Vec<Record>,
    /// What the host refused.
    pub refusals: Vec<Refusal>,
}

/// What every thread is started with.
pub struct Start {
    /// Every grid begins here.
    pub begin: Time,
    /// The halt channel.
    pub halt: Arc<HaltChannel>,
    /// Ends them all.
    pub stop: Arc<AtomicBool>,
}

impl Crew {
    /// Starts the threads of `shared` for `stations`, which are the layers in the creature's order.
    ///
    /// # Errors
    /// When the host refuses a thread.
    pub fn start_layers(
        &mut self,
        start: &Start,
        shared: Vec<plan::Shared>,
        stations: Vec<Station>,
    ) -> io::Result<()> {
        let mut stations: Vec<Option<Station>> = stations.into_iter().map(Some).collect();
        let mut records: Vec<(usize, Record)> = Vec::new();
        for plan::Shared { plan, layers } in shared {
            let (mut running, mut gauges, mut specs) = (Vec::new(), Vec::new(), Vec::new());
            for &index in &layers {
                let station = stations[index].take().expect("a layer is on one thread");
                running.push(station.running);
                gauges.push(station.gauge);
                specs.push(station.spec);
            }
            let took = vec![Span::ZERO; running.len()];
            let beats = LayerBeats {
                layers: running,
                took,
            };
            let mut thread = self.beat(start, plan.clone(), beats, gauges.clone())?;
            let samples = std::mem::take(&mut thread.samples);
            for (((index, spec), gauge), samples) in layers.into_iter().zip(&specs).zip(gauges).zip(samples) {
                records.push((
                    index,
                    Record::new(&spec.name, Some(spec.level), &plan, gauge, samples),
                ));
            }
            self.beating.push(thread);
        }
        records.sort_by_key(|(index, _)| *index);
        self.records.extend(records.into_iter().map(|(_, record)| record));
        Ok(())
    }

    /// Starts the motor unit's thread.
    ///
    /// # Errors
    /// When the host refuses the thread.
    pub fn start_motor(
        &mut self,
        start: &Start,
        plan: Plan,
        motor: Motor,
        gauge: Arc<BeatGauge>,
    ) -> io::Result<()> {
        let mut thread = self.beat(start, plan.clone(), MotorBeats(motor), vec![gauge.clone()])?;
        let samples = thread.samples.pop().expect("a thread has samples of each member");
        self.records
            .push(Record::new("motor", None, &plan, gauge, samples));
        self.beating.push(thread);
        Ok(())
    }

    fn beat(
        &mut self,
        start: &Start,
        plan: Plan,
        beats: impl Beats,
        gauges: Vec<Arc<BeatGauge>>,
    ) -> io::Result<Beating> {
        let (halt, stop) = (start.halt.clone(), start.stop.clone());
        let mut thread = executor::start(plan, start.begin, beats, gauges, halt, stop)?;
        for refusal in std::mem::take(&mut thread.refusals) {
            if !self.refusals.iter().any(|r| r.grants == refusal.grants) {
                self.refusals.push(refusal);
            }
        }
        Ok(thread)
    }
}
