//! A scenario on the virtual clock, and what came of it.
//!
//! Must never know what is expected, only what to write down: at which moments to look, and at which ports.

use std::collections::{BTreeMap, BTreeSet};

use afsm::Kinds;
use daemon::gate::Causes;
use daemon::virtual_run::{BEGIN, Message, Options, Stimulus, TapView, VirtualRun};
use ipc::clock::{Span, Time};
use ipc::message::Words;

use crate::plan::{Scenario, What};

/// What came of a run.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Messages written to the wires watched, stamped from the start.
    pub wires: BTreeMap<String, Vec<(Span, Words)>>,
    /// Messages delivered to the inputs watched.
    pub inputs: BTreeMap<String, Vec<(Span, Words)>>,
    /// What was seen at each moment that an expectation names, and at the end.
    pub seen: BTreeMap<Option<Span>, Seen>,
    /// The layers that were refused, with the reasons: time, name among the manifests, reasons.
    pub refused: Vec<(Span, String, Vec<String>)>,
    /// The hash of every message on every wire.
    pub hash: u64,
    /// How many messages there were.
    pub messages: u64,
}

/// What was seen at a moment.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// States of the modules that expectations name; those that are not here at the moment are left out.
    pub states: BTreeMap<String, &'static str>,
    /// Why the gate is closed.
    pub causes: Causes,
    /// The moment, on the run's own clock.
    pub now: Time,
    /// Taps that expectations name, with whether their windows hold.
    pub taps: BTreeMap<(String, String), (TapView, bool)>,
}

/// How to run it.
#[derive(Clone, Copy, Debug, Default)]
pub struct How {
    /// Shuffles the modules of a layer within each beat, by this seed.
    pub shuffle: Option<u64>,
}

/// Runs `scenario`, built of `kinds`.
///
/// # Panics
/// When it was not checked against them.
pub fn run(scenario: &Scenario, kinds: &Kinds, how: How) -> Outcome {
    let (wires, inputs) = scenario.watched();
    let options = Options {
        start: scenario.start,
        nowhere: !scenario.world,
        keep: Some(wires.clone()),
        inputs: inputs.clone(),
        shuffle: how.shuffle,
    };
    let mut run = VirtualRun::with(scenario.creature.clone(), kinds, &options);
    let mut outcome = Outcome::default();
    let mut looks: BTreeSet<Span> = scenario.expectations.iter().filter_map(|e| e.what.at()).collect();
    let mut stimuli = scenario.stimuli.iter().peekable();
    let end = BEGIN + scenario.duration;
    loop {
        let stimulus = stimuli.peek().map(|(at, _)| BEGIN + *at);
        let look = looks.first().map(|at| BEGIN + *at);
        let Some(next) = stimulus.into_iter().chain(look).min().filter(|t| *t < end) else {
            break;
        };
        run.advance_to(next);
        let mut now: Vec<Stimulus> = Vec::new();
        while let Some((_, stimulus)) = stimuli.next_if(|(at, _)| BEGIN + *at == next) {
            now.push(stimulus.clone());
        }
        for (manifest, reasons) in run.moment(next, &now) {
            let mut names = scenario.manifests.iter();
            let name = names.find(|(_, m)| std::sync::Arc::ptr_eq(m, &manifest));
            let name = name.map_or_else(String::new, |(name, _)| name.clone());
            outcome.refused.push((next.since(BEGIN), name, reasons));
        }
        if look == Some(next) {
            looks.pop_first();
            run.settle();
            let at = next.since(BEGIN);
            outcome.seen.insert(Some(at), see(&run, scenario, next));
        }
    }
    run.advance_to(end);
    run.settle();
    outcome.seen.insert(None, see(&run, scenario, end));
    let stamped = |messages: &[Message]| -> Vec<(Span, Words)> {
        let since = |(stamp, words): &Message| (stamp.since(BEGIN), *words);
        messages.iter().map(since).collect()
    };
    let log = run.log().expect("the run keeps a log");
    for wire in wires {
        outcome.wires.insert(wire.clone(), stamped(log.messages(&wire)));
    }
    for input in inputs {
        outcome
            .inputs
            .insert(input.clone(), stamped(run.delivered(&input)));
    }
    (outcome.hash, outcome.messages) = (log.hash(), log.count());
    outcome
}

fn see(run: &VirtualRun, scenario: &Scenario, now: Time) -> Seen {
    let mut seen = Seen {
        causes: run.machine.halt.decided().0,
        now,
        ..Seen::default()
    };
    for expectation in &scenario.expectations {
        match &expectation.what {
            What::State { module, .. } => {
                if let Some(state) = run.state_of(module) {
                    seen.states.insert(module.clone(), state);
                }
            }
            What::Tap { from, to, .. } => {
                if let Some(tap) = run.tap(from, to) {
                    let holds = tap.window.is_some_and(|w| w.holds(now));
                    seen.taps.insert((from.clone(), to.clone()), (tap, holds));
                }
            }
            _ => {}
        }
    }
    seen
}

impl What {
    /// The moment at which something has to be looked at, if not at the end.
    fn at(&self) -> Option<Span> {
        match self {
            What::State { at, .. } | What::Halted { at, .. } | What::Tap { at, .. } => *at,
            What::Messages(_) | What::Order { .. } | What::Refused { .. } => None,
        }
    }
}
