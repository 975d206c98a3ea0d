//! A panic inside the daemon whose message nobody reads: the body halts all the same, and before the message.

mod scene;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use afsm::kind::{ModuleKind, Settings};
use afsm::module::{Beat, Module};
use daemon::feeder::Fed;
use daemon::gate::Causes;
use daemon::machine::{Machine, kinds};
use daemon::recorder;
use daemon::running;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Declaration, Port, Source, check};
use scene::wait_for;

/// While set, the module panics at its next step.
static TOLD: AtomicBool = AtomicBool::new(false);

/// Set while a panic is being reported; the report does not end before it is taken back.
static REPORTING: AtomicBool = AtomicBool::new(false);

struct Panics;

impl Module for Panics {
    fn step(&mut self, _: &mut Beat<'_>) {
        assert!(!TOLD.load(Ordering::Relaxed), "as told");
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "on trial"
    }
}

static DECLARATION: Declaration = Declaration {
    name: "tried.panics",
    about: "panics when told so",
    diagram: "",
    inputs: &[],
    outputs: &[Port::new("out", ipc::message::Kind::Pulse, "never written")],
    parameters: &[],
};

static PANICS: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |_: &Settings<'_>| Box::new(Panics),
};

#[test]
fn a_panic_halts_the_body_before_it_is_reported_and_for_good() {
    let name = format!("panics{}", std::process::id());
    let text = format!(
        "{}\n[[layer]]\nname = \"trial\"\nlevel = 1\nperiod = \"10ms\"\n[layer.modules]\n\
         trial = {{ kind = \"tried.panics\" }}\n",
        allen::CREATURE
    );
    let kinds = kinds().with([&PANICS]);
    let creature = check::creature(&Source::new(&name, text), &kinds).expect("a sound creature");
    let domain = Domain::join(&name).expect("shared memory");
    let cells = output_ports(&creature).count();
    let owned = domain.own(&name, cells).expect("a name of its own");
    // A standard error that nobody reads.
    std::panic::set_hook(Box::new(|_| {
        REPORTING.store(true, Ordering::Relaxed);
        while REPORTING.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }));
    daemon::panicked::guard();
    let machine = Machine::new(creature, &kinds, owned.page().clone(), None);
    let settings = recorder::Settings::default();
    let running = running::start(&name, machine, owned, domain, &settings, None, Fed::default());
    let running = running.expect("threads");
    let halt = running.shared.halt.clone();
    let causes = || halt.decided().0.without(Causes::REFLEX);
    wait_for("it is free", || causes() == Causes::NONE);
    TOLD.store(true, Ordering::Relaxed);
    wait_for("it is halted", || causes().has(Causes::PANIC));
    assert!(
        REPORTING.load(Ordering::Relaxed),
        "halted while it is still reported"
    );
    let refusal = halt.reset().expect_err("nothing resets a broken daemon");
    assert!(refusal.contains("panicked"), "{refusal}");
    REPORTING.store(false, Ordering::Relaxed);
    running.shut_down();
}
