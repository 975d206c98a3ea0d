//! Halts that latch, on a running daemon: a vital layer that stops beating, a layer that overruns under policy
//! halt, an emergency stop. A reset is refused for as long as the cause stands; nothing taps the halt channel.

mod scene;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use afsm::kind::{ModuleKind, Settings};
use afsm::module::{Beat, Module};
use daemon::feeder::Fed;
use daemon::gate::Causes;
use daemon::machine::{Machine, kinds};
use daemon::recorder;
use daemon::running::{self, Running};
use ipc::wire::iceoryx::Domain;
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Declaration, Port, Source, check};
use scene::wait_for;

/// While set, the module `hold` does not come back from its step.
static HELD: AtomicBool = AtomicBool::new(false);

struct Hold;

impl Module for Hold {
    fn step(&mut self, _beat: &mut Beat<'_>) {
        while HELD.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "held"
    }
}

static DECLARATION: Declaration = Declaration {
    name: "tried.hold",
    about: "does not come back from its step while told so",
    diagram: "",
    inputs: &[],
    outputs: &[Port::new("out", ipc::message::Kind::Pulse, "never written")],
    parameters: &[],
};

static HOLD: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |_: &Settings<'_>| Box::new(Hold),
};

/// Allen with one more layer, in which the module stands.
fn start(name: &str, layer: &str) -> Running {
    let text = format!(
        "{}\n[[layer]]\nname = \"held\"\nlevel = 1\nperiod = \"10ms\"\n{layer}\n[layer.modules]\nhold = {{ kind = \"tried.hold\" }}\n",
        allen::CREATURE
    );
    let kinds = kinds().with([&HOLD]);
    let creature = check::creature(&Source::new(name, text), &kinds).expect("a sound creature");
    let domain = Domain::join(name).expect("shared memory");
    let owned = domain
        .own(name, output_ports(&creature).count())
        .expect("a name of its own");
    let machine = Machine::new(creature, &kinds, owned.page().clone(), None);
    let settings = recorder::Settings::default();
    running::start(name, machine, owned, domain, &settings, None, Fed::default()).expect("threads")
}

fn until(running: &Running, what: &str, there: impl Fn(Causes) -> bool) {
    let halt = running.shared.halt.clone();
    wait_for(what, || there(halt.decided().0.without(Causes::REFLEX)));
}

#[test]
fn lost_vital_layers_and_overruns_latch_until_a_reset_that_is_refused_while_they_stand() {
    for (name, layer, cause) in [
        ("vital", "vital = true", Causes::VITAL),
        ("strict", "overrun = \"halt\"", Causes::OVERRUN),
    ] {
        let name = format!("{name}{}", std::process::id());
        let running = start(&name, layer);
        until(&running, "it is free", |causes| causes == Causes::NONE);
        let halt = Arc::clone(&running.shared.halt);
        HELD.store(true, Ordering::Relaxed);
        until(&running, "it is halted in mid-step", |causes| causes.has(cause));
        let refusal = halt.reset().expect_err("the cause stands");
        assert!(refusal.contains("the cause still stands"), "{refusal}");
        assert!(halt.decided().0.has(cause), "a refused reset ends nothing");
        HELD.store(false, Ordering::Relaxed);
        wait_for("the cause is mended", || halt.watched() == Causes::NONE);
        std::thread::sleep(Duration::from_millis(100));
        assert!(halt.decided().0.has(cause), "it stays until the reset");
        wait_for("a reset ends it", || {
            let _ = halt.reset();
            std::thread::sleep(Duration::from_millis(50));
            halt.decided().0.without(Causes::REFLEX) == Causes::NONE
        });
        let counted = halt.counts().into_iter().find(|c| c.cause == cause);
        assert!(
            counted.is_some_and(|c| c.count >= 1 && c.began.0 > 0),
            "{counted:?}"
        );
        running.shut_down();
    }
}

#[test]
fn an_emergency_stop_latches_and_a_reset_ends_it() {
    let running = start(&format!("stop{}", std::process::id()), "");
    until(&running, "it is free", |causes| causes == Causes::NONE);
    running.shared.halt.halt(Causes::EMERGENCY);
    until(&running, "it is halted", |causes| causes == Causes::EMERGENCY);
    std::thread::sleep(Duration::from_millis(100));
    assert!(
        running.shared.halt.decided().0.has(Causes::EMERGENCY),
        "it latches"
    );
    running.shared.halt.reset().expect("nothing stands");
    until(&running, "it is free again", |causes| causes == Causes::NONE);
    running.shut_down();
}

#[test]
fn a_creature_file_that_taps_the_halt_channel_is_refused() {
    let tap = "[[layer]]\nname = \"deaf\"\nlevel = 1\nperiod = \"20ms\"\n\
               wires = [\"body.compass -> still.compass, quiet.compass\", \"still.heading -> quiet.goal\", \"feelforce.force -> quiet.force\"]\n\
               inhibit = [{ from = \"quiet.heading\", output = \"collide.halt\", time_constant = \"1s\" }]\n\
               [layer.modules]\nstill = { kind = \"allen.wander\", every = \"10s\" }\nquiet = { kind = \"allen.avoid\" }\n";
    let text = format!("{}\n{tap}", allen::CREATURE);
    let refused = check::creature(&Source::new("deaf.toml", text), &kinds()).expect_err("it is refused");
    let refused = refused.to_string();
    assert!(
        refused.contains("collide.halt is part of the halt channel"),
        "{refused}"
    );
}
