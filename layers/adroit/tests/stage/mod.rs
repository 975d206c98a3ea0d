//! A body of bare switches: stimuli, goals and goal states set by hand, to test the rules one by one.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its own part")]

use std::collections::BTreeMap;

use adroit::hierarchy::{CriterionId, Goal, Hierarchy, Senses, StateId, StimulusId};
use adroit::language::{Running, Vocabulary};

/// Stimuli `a` to `h`, criteria `p` to `s`, states `x` to `z`, MCUs `m` to `r`.
#[must_use]
pub fn vocabulary() -> Vocabulary {
    Vocabulary::new(
        &["a", "b", "c", "d", "e", "f", "g", "h"],
        &["p", "q", "r", "s"],
        &["x", "y", "z"],
        &["m", "n", "o", "p", "q", "r"],
    )
}

/// Values by name; what is not set is absent.
#[derive(Default)]
pub struct Switches {
    /// Values of stimuli.
    pub stimuli: BTreeMap<u16, f64>,
    /// Goals by criterion.
    pub goals: BTreeMap<u16, Goal>,
    /// Goal states that hold.
    pub states: Vec<u16>,
}

impl Switches {
    /// Sets a stimulus.
    pub fn set(&mut self, name: &str, value: f64) -> &mut Self {
        self.stimuli
            .insert(vocabulary().stimulus(name).expect("known").0, value);
        self
    }

    /// Sets the goal a criterion finds.
    pub fn goal(&mut self, name: &str, goal: Option<Goal>) -> &mut Self {
        let criterion = vocabulary().criterion(name).expect("known").0;
        match goal {
            Some(goal) => self.goals.insert(criterion, goal),
            None => self.goals.remove(&criterion),
        };
        self
    }

    /// Makes a goal state hold or not.
    pub fn state(&mut self, name: &str, holds: bool) -> &mut Self {
        let state = vocabulary().state(name).expect("known").0;
        self.states.retain(|&known| known != state);
        if holds {
            self.states.push(state);
        }
        self
    }
}

impl Senses for Switches {
    fn stimulus(&self, stimulus: StimulusId, _: &Goal) -> f64 {
        self.stimuli.get(&stimulus.0).copied().unwrap_or(0.0)
    }

    fn select(&self, criterion: CriterionId, _: &Goal) -> Option<Goal> {
        self.goals.get(&criterion.0).copied()
    }

    fn holds(&self, state: StateId, _: &Goal) -> bool {
        self.states.contains(&state.0)
    }
}

/// Loads a program, with a maintenance RM that works MCU `r` when nothing else is excited.
#[must_use]
pub fn running(program: &str) -> Running {
    let rest = "rm maintenance reports to top. add stimulus always to rm maintenance with magnitude 0.01.
        mcu r reports to rm maintenance.";
    Running::load(&format!("{program}\n{rest}"), vocabulary()).unwrap_or_else(|problems| panic!("{problems}"))
}

/// The names of the MCUs put to work, in order.
#[must_use]
pub fn working(hierarchy: &Hierarchy) -> Vec<String> {
    let vocabulary = vocabulary();
    hierarchy
        .outputs()
        .iter()
        .map(|output| vocabulary.mcu_name(output.mcu).to_owned())
        .collect()
}

/// Evaluates once and names the MCUs put to work.
pub fn evaluated(running: &mut Running, switches: &Switches) -> Vec<String> {
    running.hierarchy_mut().evaluate(switches);
    working(running.hierarchy())
}

/// A top-level RM with one stimulus and one MCU.
#[must_use]
pub fn simple(rm: &str, stimulus: &str, magnitude: f64, mcu: &str) -> String {
    format!(
        "rm {rm} reports to top. add stimulus {stimulus} to rm {rm} with magnitude {magnitude}. mcu {mcu} reports \
         to rm {rm}.\n"
    )
}
