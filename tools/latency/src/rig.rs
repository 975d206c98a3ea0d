//! A rig: layers of plain modules on wires in memory, to see what a step costs.
//!
//! ```text
//!   module i:   a ◄──(S ◄── tap wire i)── out(i−1)      out(i) = a + b, every beat
//!               b ◄──────────────────── out(i−2)
//! ```
//! Must never do anything a creature doesn't: these are the registers, outlets and layers of every creature.
//! So each module has two inputs that carry a new message every beat, one output, and one suppressor; n
//! modules make 2n wires.

use std::sync::Arc;

use afsm::layer::{Hand, RunningLayer};
use afsm::{Beat, In, Module, ModuleKind, Out};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Payload};
use ipc::wire::{Limits, Outlet, Page, Register, Room, TapEnd, TapGauge, Writer};
use ipc::wiring::{Declaration, Port};

const A: In<f64> = In::at(0);
const B: In<f64> = In::at(1);
const OUT: Out<f64> = Out::at(0);

/// The kind `lab.mix`.
pub static MIX: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |_| Box::new(Mix { state: State::Silent }),
};

static DECLARATION: Declaration = Declaration {
    name: "lab.mix",
    about: "says the sum of its inputs every beat, once both were heard",
    diagram: "Silent --a, b--> Mixing",
    inputs: &[
        Port::new("a", Kind::Number, "one number"),
        Port::new("b", Kind::Number, "another"),
    ],
    outputs: &[Port::new("out", Kind::Number, "half their sum")],
    parameters: &[],
};

#[derive(Clone, Copy)]
enum State {
    Silent,
    Mixing,
}

/// Two inputs, one output, two states.
struct Mix {
    state: State,
}

impl Module for Mix {
    fn step(&mut self, beat: &mut Beat<'_>) {
        match self.state {
            State::Silent => {
                beat.emit(OUT, 1.0);
                if beat.arrived(A).is_some() && beat.arrived(B).is_some() {
                    self.state = State::Mixing;
                }
            }
            State::Mixing => {
                if let (Some(a), Some(b)) = (beat.latest(A), beat.latest(B)) {
                    beat.emit(OUT, 0.5 * (a + b));
                }
            }
        }
    }

    fn reset(&mut self) {
        self.state = State::Silent;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Silent => "Silent",
            State::Mixing => "Mixing",
        }
    }
}

/// Time between two beats of a rig on its own clock.
pub const BEAT: Span = Span::millis(1);

/// Time constant of every suppressor.
const TAU: Span = Span::micros(300);

/// Layers of plain modules, and the wires of their suppressors.
#[derive(Debug)]
pub struct Rig {
    /// The layers.
    pub layers: Vec<RunningLayer>,
    /// The wires of the suppressors, one a module.
    pub taps: Vec<Writer>,
    now: Time,
    _hands: Vec<Hand>,
}

/// What the ports of a rig take.
pub const LIMITS: Limits = Limits {
    kind: Kind::Number,
    low: f64::MIN,
    high: f64::MAX,
};

impl Rig {
    /// `layers` layers of `each` modules, on a page in memory.
    pub fn new(layers: usize, each: usize) -> Rig {
        Rig::on(&Page::in_memory(2 * layers * each), layers, each)
    }

    /// `layers` layers of `each` modules on the first wires of `page`.
    ///
    /// # Panics
    /// When the page has fewer wires than twice the modules, or their writers are taken.
    pub fn on(page: &Arc<Page>, layers: usize, each: usize) -> Rig {
        let modules = layers * each;
        let (mut running, mut hands) = (Vec::new(), Vec::new());
        for l in 0..layers {
            let (mut layer, hand) = RunningLayer::new();
            layer.reserve(each, 3 * each, each);
            for m in 0..each {
                let i = l * each + m;
                let (registers, outlet) = ports(page, i, modules);
                let machine = Box::new(Mix { state: State::Silent });
                layer.seat(&format!("mix{i}"), &MIX, machine, registers, vec![outlet], false);
            }
            running.push(layer);
            hands.push(hand);
        }
        let taps = (modules..2 * modules).map(|i| page.writer(i, Kind::Number).expect("free"));
        let mut rig = Rig {
            layers: running,
            taps: taps.collect(),
            now: Time(1_000_000_000),
            _hands: hands,
        };
        // Everything has spoken once, so that nothing is met for the first time later.
        for _ in 0..3 {
            rig.speak();
            rig.beat();
        }
        rig
    }

    /// Every suppressor speaks, just before the next beat.
    pub fn speak(&mut self) {
        let stamp = self.now + Span(BEAT.0 - 1);
        self.taps.iter_mut().for_each(|tap| tap.write(stamp, &2.0.pack()));
    }

    /// Every layer beats once.
    pub fn beat(&mut self) {
        self.now = self.now + BEAT;
        for layer in &mut self.layers {
            layer.step(self.now);
            layer.commit(self.now);
        }
    }
}

/// The registers and the outlet of module `i` of `n`.
fn ports(page: &Arc<Page>, i: usize, n: usize) -> (Vec<Register>, Outlet) {
    let reader = |wire: usize| page.reader(wire, Kind::Number);
    let mut a = Register::new(LIMITS, reader((i + n - 1) % n));
    let tap = TapEnd {
        reader: reader(n + i).expect("the page has a wire for each suppressor"),
        time_constant: TAU,
        level: 1,
        plug: 0,
        gauge: Arc::new(TapGauge::default()),
        room: Room::none(),
    };
    a.suppress(tap).expect("there is room for one");
    let b = Register::new(LIMITS, reader((i + 2 * n - 2) % n));
    let reset = Register::new(LIMITS, None);
    let outlet = Outlet::new(page.writer(i, Kind::Number).expect("free"));
    (vec![a, b, reset], outlet)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_of_a_rig_mixes_and_every_wire_gets_a_message_a_beat() {
        let page = Page::in_memory(24);
        let mut rig = Rig::on(&page, 3, 4);
        let number = |i| page.reader(i, Kind::Number).unwrap().read().unwrap().number;
        let before: Vec<u64> = (0..12).map(number).collect();
        rig.beat();
        for (i, before) in before.into_iter().enumerate() {
            assert_eq!(number(i), before + 1, "wire {i}");
        }
        for layer in 0..3 {
            assert_eq!(
                rig.layers[layer].state_of(&format!("mix{}", layer * 4)),
                Some("Mixing")
            );
        }
    }

    #[test]
    fn a_suppressor_that_speaks_is_heard_and_one_that_does_not_lets_the_wire_through() {
        let page = Page::in_memory(2);
        let mut rig = Rig::on(&page, 1, 1);
        let out = || page.reader(0, Kind::Number).unwrap().read().unwrap().words[0];
        (0..60).for_each(|_| {
            rig.speak();
            rig.beat();
        });
        assert!((out() - 2.0).abs() < 1e-9, "the suppressor says 2: {}", out());
        (0..10).for_each(|_| rig.beat());
        let settled = out();
        rig.beat();
        assert_eq!(out(), settled, "the mean of what it said itself");
    }
}
