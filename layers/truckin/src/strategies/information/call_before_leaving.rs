//! Before doing anything else, call all over the country until every kind of dealer is known.

use backplane::{BehaviourLayer, Feedback};

use super::CallList;
use crate::ootland::chance::Chance;
use crate::ootland::rules::TRUCK_CAPITAL_CENTS;
use crate::ootland::{Controller, Grid, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// What it will spend on calls, in cents.
const BUDGET_CENTS: i64 = TRUCK_CAPITAL_CENTS / 5;

/// Calls first, drives later.
pub struct CallBeforeLeaving {
    notebook: Notebook,
    to_call: CallList,
    done: bool,
}

impl MicroStrategy for CallBeforeLeaving {
    fn new(grid: Grid, mut chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            to_call: CallList::new(grid, &mut chance),
            done: false,
        }
    }
}

impl BehaviourLayer<TruckCreature> for CallBeforeLeaving {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        if !self.done {
            self.notebook.learn(heard, body);
            let spent = body.capital_cents() < TRUCK_CAPITAL_CENTS - BUDGET_CENTS;
            self.done = spent || self.notebook.knows_every_kind();
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if self.done {
            return;
        }
        while let Some(corner) = self.to_call.next_unknown(&self.notebook) {
            if corner != body.corner() {
                proposal.inhibit_all_below();
                add(proposal, TruckAction::Phone(corner));
                return;
            }
        }
        self.done = true;
    }
}
