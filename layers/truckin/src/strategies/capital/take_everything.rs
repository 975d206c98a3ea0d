//! Sell whatever is wanted here, buy as much as all the money buys.

use backplane::{BehaviourLayer, Feedback};

use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::counter::Counter;
use crate::strategies::roads::{TruckProposal, add};

/// Buys and sells everything.
#[derive(Default)]
pub struct TakeEverything {
    counter: Counter,
}

impl MicroStrategy for TakeEverything {
    fn new(_: Grid, _: Chance) -> Self {
        Self::default()
    }
}

impl BehaviourLayer<TruckCreature> for TakeEverything {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.counter.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if let Some(deal) = self.counter.in_demand(body) {
            add(proposal, TruckAction::Sell(deal.units));
        } else if let Some(deal) = self.counter.on_sale(body, 0) {
            add(proposal, TruckAction::Buy(deal.units));
        }
    }
}
