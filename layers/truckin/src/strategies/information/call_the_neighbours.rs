//! Arriving somewhere with unknown corners close by, call one of them before driving on.

use backplane::{BehaviourLayer, Feedback};

use super::inhibit_trading;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// How close is close by, in steps.
const NEAR_STEPS: i32 = 2;
/// Money below which it does not call, in cents.
const THRIFT_CENTS: i64 = 10_000;

/// Calls one neighbour at each new place.
pub struct CallTheNeighbours {
    notebook: Notebook,
    called_from: Option<Corner>,
}

impl MicroStrategy for CallTheNeighbours {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            called_from: None,
        }
    }
}

impl BehaviourLayer<TruckCreature> for CallTheNeighbours {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
        if heard.was_mine() {
            self.called_from = Some(body.corner());
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        let here = body.corner();
        if self.called_from == Some(here) || body.capital_cents() < THRIFT_CENTS {
            return;
        }
        let unknown = self.notebook.nearest_unknown(here);
        match unknown.filter(|unknown| body.grid().steps(here, *unknown) <= NEAR_STEPS) {
            Some(unknown) => {
                inhibit_trading(proposal);
                add(proposal, TruckAction::Phone(unknown));
            }
            None => self.called_from = Some(here),
        }
    }
}
