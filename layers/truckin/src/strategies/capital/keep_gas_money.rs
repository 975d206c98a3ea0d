//! Sell whatever is wanted here, buy with all the money but the price of a full tank.

use backplane::{BehaviourLayer, Feedback};

use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::counter::Counter;
use crate::strategies::roads::{TruckProposal, add};

/// What it keeps: a full tank at a dear station, in cents.
const KEEP_CENTS: i64 = 6_500;

/// Never spends its gas money on goods.
#[derive(Default)]
pub struct KeepGasMoney {
    counter: Counter,
}

impl MicroStrategy for KeepGasMoney {
    fn new(_: Grid, _: Chance) -> Self {
        Self::default()
    }
}

impl BehaviourLayer<TruckCreature> for KeepGasMoney {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.counter.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if let Some(deal) = self.counter.in_demand(body) {
            add(proposal, TruckAction::Sell(deal.units));
        } else if let Some(deal) = self.counter.on_sale(body, KEEP_CENTS) {
            add(proposal, TruckAction::Buy(deal.units));
        }
    }
}
