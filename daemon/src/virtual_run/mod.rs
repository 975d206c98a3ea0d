//! A run on the virtual clock: the same layers, wiring and body, stepped in one thread as fast as it goes.
//!
//! Must never depend on the order of things that happen at one moment: every layer due looks at its registers
//! before any of them writes, and those of a higher level write first, so that an inhibitor's message
//! of this very moment counts.
//!
//! ```text
//!   t ─► layers come and go ─► layers not due look ─► gather and step every layer due ─► motor unit gathers
//!     ─► puts and commits, highest level first ─► motor unit acts ─► world ticks ─► next t
//! ```
//! One thing differs from real time: here every register and tap sees *every* message, since those that are
//! not due look between their beats as well. In real time messages that come faster than the reader's beat
//! overwrite each other; what the register holds at the beat is the same, only less is counted.

mod guests;
mod log;
mod views;
mod writing;

use afsm::Kinds;
use afsm::random::Random;
use ipc::clock::{Span, Time};
use ipc::message::Words;
use ipc::wire::Page;
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::output_ports;
use std::sync::Arc;

use crate::body::{Nowhere, Place};
use crate::gate::Causes;
use crate::machine::{Machine, Station};

pub use guests::{Guest, Manifest};
pub use log::{Log, Message};
pub use views::TapView;

use guests::Guests;

/// The moment at which virtual time begins: not zero, so that nothing is mistaken for never.
pub const BEGIN: Time = Time(1_000_000_000);

/// What a run is made of beside the creature.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where the body starts, if a certain place is wanted.
    pub start: Option<Place>,
    /// Whether there is no world behind the body: sensors say nothing of their own.
    pub nowhere: bool,
    /// The wires whose messages are kept in the log; without any log if `None`.
    pub keep: Option<Vec<String>>,
    /// The inputs whose deliveries are kept.
    pub inputs: Vec<String>,
    /// Steps the modules of a layer in an order of this seed, another one each beat.
    pub shuffle: Option<u64>,
}

/// What happens to a run from outside.
#[derive(Clone, Debug)]
pub enum Stimulus {
    /// A message on the output port called so, as though its module emitted it at that moment.
    Put(String, Words),
    /// A layer joins.
    Plug(Arc<Manifest>),
    /// The layer called so leaves, whether it says so or not.
    Leave(String),
    /// The beats of the layer called so stop.
    Freeze(String),
    /// They go on.
    Thaw(String),
    /// The operator's emergency stop.
    Halt,
    /// The end of it.
    Reset,
}

/// Which layer of a run: one of the creature, or the n-th guest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Own(usize),
    Guest(usize),
}

/// An input whose deliveries are kept.
struct WatchedInput {
    name: String,
    delivered: u64,
    messages: Vec<Message>,
}

/// A creature on the virtual clock.
pub struct VirtualRun {
    /// The machine being stepped.
    pub machine: Machine,
    now: Time,
    due: Vec<Option<Time>>,
    body_due: Time,
    guests: Guests,
    /// Every layer, the highest level first.
    order: Vec<Which>,
    log: Option<Log>,
    /// First wire of each layer of the creature in the log; they stand there in the creature's order.
    first: Vec<usize>,
    inputs: Vec<WatchedInput>,
    shuffle: Option<Random>,
}

impl VirtualRun {
    /// A run that is about to begin, without a log.
    pub fn new(machine: Machine) -> VirtualRun {
        VirtualRun::over(machine, &Kinds::default(), &Options::default())
    }

    /// A run of `creature` with everything asked for in `options`; guests are built of `kinds`.
    ///
    /// # Panics
    /// When the creature was not checked against `kinds`.
    pub fn with(creature: Creature, kinds: &Kinds, options: &Options) -> VirtualRun {
        let page = Page::in_memory(output_ports(&creature).count());
        let mut machine = Machine::new(creature, kinds, page, options.start);
        if let Some(body) = machine.body.as_mut().filter(|_| options.nowhere) {
            body.world = Box::new(Nowhere);
        }
        VirtualRun::over(machine, kinds, options)
    }

    fn over(machine: Machine, kinds: &Kinds, options: &Options) -> VirtualRun {
        let begin = |s: &Station| Some(BEGIN + s.spec.phase);
        let due = machine.stations.iter().map(begin).collect();
        let guests = Guests::new(&machine.creature, kinds.clone(), &machine.taps);
        let mut log = options.keep.clone().map(Log::new);
        if let Some(log) = &mut log {
            for (index, (name, port, _)) in output_ports(&machine.creature).enumerate() {
                let reader = machine.page.reader(index, port.kind).expect("one cell a wire");
                log.wire(name.to_string(), reader);
            }
        }
        let body = machine.creature.body.as_ref();
        let mut next = body.map_or(0, |b| b.declaration.outputs.len());
        let first = machine.creature.layers.iter().map(|layer| {
            let outputs = layer.modules.iter().map(|m| m.declaration.outputs.len());
            let first = next;
            next += outputs.sum::<usize>();
            first
        });
        let first = first.collect();
        let watched = |name: &String| WatchedInput {
            name: name.clone(),
            delivered: 0,
            messages: Vec::new(),
        };
        let mut run = VirtualRun {
            machine,
            now: BEGIN,
            due,
            body_due: BEGIN,
            guests,
            order: Vec::new(),
            log,
            first,
            inputs: options.inputs.iter().map(watched).collect(),
            shuffle: options.shuffle.map(Random::new),
        };
        run.set_order();
        run
    }

    /// The virtual time, since [`BEGIN`].
    pub fn elapsed(&self) -> Span {
        self.now.since(BEGIN)
    }

    /// Lets `span` pass.
    pub fn advance(&mut self, span: Span) {
        self.advance_to(self.now + span);
    }

    /// Lets time pass up to `end`; what is due at `end` itself does not happen yet.
    pub fn advance_to(&mut self, end: Time) {
        while let Some(t) = self.next_beat().filter(|t| *t < end) {
            self.moment(t, &[]);
        }
        self.now = end;
    }

    /// Kills the `station`-th layer: it beats no more, and what its taps said last runs out by itself.
    pub fn kill(&mut self, station: usize) {
        self.due[station] = None;
    }

    /// Starts a killed layer again as its process would be: every module in its initial state, nothing in
    /// its registers.
    pub fn restart(&mut self, station: usize) {
        let Station { spec, running, .. } = &mut self.machine.stations[station];
        running.restart();
        self.due[station] = Some((BEGIN + spec.phase).on_grid(spec.period, self.now));
    }

    /// When the next beat is due.
    pub fn next_beat(&self) -> Option<Time> {
        let layers = self.due.iter().copied().flatten();
        let guests = self.guests.here.iter().filter_map(|g| g.due);
        let body = self.machine.body.is_some().then_some(self.body_due);
        layers.chain(guests).chain(body).min()
    }

    /// Everything that happens at `t`: the `stimuli` and what is due. Why layers were refused, with their names.
    ///
    /// # Panics
    /// When a beat before `t` has not happened yet.
    pub fn moment(&mut self, t: Time, stimuli: &[Stimulus]) -> Vec<(Arc<Manifest>, Vec<String>)> {
        assert!(self.next_beat().is_none_or(|due| due >= t), "time runs forward");
        self.now = t;
        let refused = self.meddle(stimuli);
        self.look(|due| due != Some(t));
        self.step();
        self.commit(stimuli);
        refused
    }

    /// Takes in what was written last, so that registers, taps and kept deliveries stand as after this moment.
    pub fn settle(&mut self) {
        self.look(|_| true);
    }

    /// Layers come and go, the operator halts and resets.
    fn meddle(&mut self, stimuli: &[Stimulus]) -> Vec<(Arc<Manifest>, Vec<String>)> {
        let mut refused = Vec::new();
        let joining = |s: &Stimulus| matches!(s, Stimulus::Plug(_) | Stimulus::Leave(_));
        if stimuli.iter().any(joining) {
            // What a layer wrote before it went is heard.
            self.look(|_| true);
        }
        for stimulus in stimuli {
            let hands = &mut self.machine.hands;
            match stimulus {
                Stimulus::Put(..) => continue,
                Stimulus::Plug(manifest) => {
                    let creature = (&self.machine.creature, &self.machine.page);
                    match self.guests.plug(manifest, self.now, creature, hands) {
                        Ok(index) => self.welcome(index),
                        Err(reasons) => refused.push((manifest.clone(), reasons)),
                    }
                }
                Stimulus::Leave(name) => {
                    self.guests.leave(name, hands);
                }
                Stimulus::Freeze(name) => self.set_due(name, |_, _| None),
                Stimulus::Thaw(name) => {
                    let now = self.now;
                    self.set_due(name, |first, period| Some(first.on_grid(period, now)));
                }
                Stimulus::Halt => self.machine.halt.halt(Causes::EMERGENCY),
                Stimulus::Reset => {
                    // Refused while its cause stands; then nothing happens, and the halt says why.
                    let _ = self.machine.halt.reset();
                }
            }
            if joining(stimulus) {
                let guests = self.guests.here.iter_mut().map(|g| &mut g.station);
                let stations = self.machine.stations.iter_mut().chain(guests);
                stations.for_each(|s| s.running.take_up());
                self.set_order();
            }
        }
        refused
    }

    /// A guest's wires are logged, and its inputs watched anew.
    fn welcome(&mut self, index: usize) {
        let guest = &mut self.guests.here[index];
        if let Some(log) = &mut self.log {
            for (wire, output) in guest.plug.outputs.iter().enumerate() {
                let reader = guest.page.reader(wire, output.kind).expect("one cell a wire");
                guest.logged.push(log.wire(output.name.clone(), reader));
            }
        }
        for input in &mut self.inputs {
            let module = input.name.split_once('.').map(|(module, _)| module);
            if guest
                .station
                .spec
                .modules
                .iter()
                .any(|m| Some(m.name.as_str()) == module)
            {
                input.delivered = 0;
            }
        }
    }

    /// Sets when the layer called `name` beats next, told one of its beats and its period.
    fn set_due(&mut self, name: &str, due: impl Fn(Time, Span) -> Option<Time>) {
        let own = self.machine.stations.iter().zip(&mut self.due);
        for (station, was) in own.filter(|(s, _)| s.spec.name == name) {
            *was = due(BEGIN + station.spec.phase, station.spec.period);
        }
        for guest in self.guests.here.iter_mut().filter(|g| g.plug.layer == name) {
            // Any grid will do for a guest: its process takes up a new one whenever it goes on.
            guest.due = due(self.now, guest.station.spec.period);
        }
    }

    fn set_order(&mut self) {
        let own = self.machine.stations.iter().enumerate();
        let own = own.map(|(i, s)| (s.spec.level, Which::Own(i)));
        let guests = self.guests.here.iter().enumerate();
        let guests = guests.map(|(i, g)| (g.plug.level, Which::Guest(i)));
        let mut order: Vec<_> = own.chain(guests).collect();
        order.sort_by_key(|(level, _)| std::cmp::Reverse(*level));
        self.order = order.into_iter().map(|(_, which)| which).collect();
    }

    /// Every layer due looks at its registers and steps, then the motor unit looks at its own.
    fn step(&mut self) {
        let t = self.now;
        let own = self.machine.stations.iter_mut().zip(&self.due);
        let own = own
            .filter(|(_, due)| **due == Some(t))
            .map(|(station, _)| station);
        let guests = self.guests.here.iter_mut().filter(|g| g.due == Some(t));
        for station in own.chain(guests.map(|g| &mut g.station)) {
            if let Some(random) = &mut self.shuffle {
                station
                    .running
                    .set_order(&shuffled(station.running.len(), random));
            }
            station.running.step(t);
        }
        // The motor unit looks before anything of this moment is written.
        if let Some(body) = self.machine.body.as_mut().filter(|_| self.body_due == t) {
            body.motor.gather(t);
        }
    }
}

/// The numbers below `n` in an order of `random`.
fn shuffled(n: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, random.between(0.0, (i + 1) as f64) as usize);
    }
    order
}
