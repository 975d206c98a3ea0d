//! Cases: the pieces of work whose cost is kept, in instructions and in time.
//!
//! Must never be changed to make a number smaller: a case says what is done, the number what it costs.

use std::hint::black_box;
use std::sync::Arc;

use afsm::trace::trace;
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Payload};
use ipc::tap::{self, Window};
use ipc::wire::{Outlet, Page, Register, Room, TapEnd, TapGauge};

use crate::rig::{BEAT, LIMITS, Rig};

/// A piece of work.
#[derive(Clone, Copy)]
pub struct Case {
    /// Its name, as it stands in `tests/instructions.txt`.
    pub name: &'static str,
    /// What one turn of it does.
    pub about: &'static str,
    /// Makes it ready; what is returned does one turn.
    pub ready: fn() -> Box<dyn FnMut()>,
}

/// Every case.
pub const CASES: &[Case] = &[
    Case {
        name: "tap_decision",
        about: "whether one message gets through one suppressor",
        ready: || decision(1),
    },
    Case {
        name: "tap_decision_3",
        about: "whether one message gets through three suppressors",
        ready: || decision(3),
    },
    Case {
        name: "register_read_old",
        about: "a look at a wire that has nothing new",
        ready: || register(false, false),
    },
    Case {
        name: "register_read",
        about: "one number written to a wire and read into a register",
        ready: || register(true, false),
    },
    Case {
        name: "register_read_tapped",
        about: "the same with a suppressor joined that says nothing",
        ready: || register(true, true),
    },
    Case {
        name: "wire_write",
        about: "one number staged in an outlet and written to its wire",
        ready: write,
    },
    Case {
        name: "beat_1",
        about: "a beat of a layer of one module: two inputs, one output, a suppressor",
        ready: || beat(1),
    },
    Case {
        name: "beat_10",
        about: "a beat of a layer of ten such modules",
        ready: || beat(10),
    },
    Case {
        name: "beat_100",
        about: "a beat of a layer of a hundred such modules",
        ready: || beat(100),
    },
    Case {
        name: "beat_100_spoken",
        about: "the same with every suppressor speaking before every beat",
        ready: || {
            let mut rig = Rig::new(1, 100);
            Box::new(move || {
                rig.speak();
                rig.beat();
            })
        },
    },
    Case {
        name: "beat_100_traced",
        about: "a beat of a layer of a hundred such modules, traced, and the trace fetched",
        ready: traced,
    },
];

/// The case called `name`.
pub fn find(name: &str) -> Option<&'static Case> {
    CASES.iter().find(|c| c.name == name)
}

fn decision(taps: usize) -> Box<dyn FnMut()> {
    let window = |k: usize| Window {
        stamp: Time(1_000_000 * k as u64),
        time_constant: Span::millis(1),
    };
    let windows: Vec<Window> = (0..taps).map(window).collect();
    let mut u = Time(5_000_000);
    Box::new(move || {
        u = u + Span(1);
        black_box(tap::passes(black_box(u), windows.iter().copied()));
    })
}

fn register(fresh: bool, tapped: bool) -> Box<dyn FnMut()> {
    let page = Page::in_memory(2);
    let mut writer = page.writer(0, Kind::Number).expect("free");
    let mut register = Register::new(LIMITS, page.reader(0, Kind::Number));
    if tapped {
        let tap = TapEnd {
            reader: page.reader(1, Kind::Number).expect("there"),
            time_constant: Span::millis(1),
            level: 1,
            plug: 0,
            gauge: Arc::new(TapGauge::default()),
            room: Room::none(),
        };
        register.suppress(tap).expect("there is room for one");
    }
    let mut now = Time(1_000_000_000);
    let message = 0.5.pack();
    writer.write(now, &message);
    register.gather(now, drop);
    Box::new(move || {
        now = now + BEAT;
        if fresh {
            writer.write(now, black_box(&message));
        }
        register.gather(now, drop);
        black_box(register.value::<f64>());
    })
}

fn write() -> Box<dyn FnMut()> {
    let page = Page::in_memory(1);
    let mut outlet = Outlet::new(page.writer(0, Kind::Number).expect("free"));
    let mut now = Time(1_000_000_000);
    Box::new(move || {
        now = now + BEAT;
        outlet.emit(black_box(0.5));
        black_box(outlet.commit(now, drop));
    })
}

fn beat(modules: usize) -> Box<dyn FnMut()> {
    let mut rig = Rig::new(1, modules);
    Box::new(move || rig.beat())
}

fn traced() -> Box<dyn FnMut()> {
    let mut rig = Rig::new(1, 100);
    let (registers, outlets) = rig.layers[0].ports();
    let (tracer, mut out) = trace(BEAT, registers, outlets);
    rig.layers[0].trace(tracer);
    Box::new(move || {
        rig.beat();
        black_box(out.next_beat());
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_runs_and_has_a_name_of_its_own() {
        for (i, case) in CASES.iter().enumerate() {
            let mut turn = (case.ready)();
            (0..5).for_each(|_| turn());
            assert!(CASES[..i].iter().all(|other| other.name != case.name));
            assert!(find(case.name).is_some());
        }
    }
}
