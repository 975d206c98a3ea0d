//! Buy at a profit while there is time to sell again; near the end turn everything into money.

use backplane::{BehaviourLayer, Feedback};

use super::{best_known_buying_cents, buyers_of};
use crate::ootland::chance::Chance;
use crate::ootland::rules::STEP_MINUTES;
use crate::ootland::{Controller, Grid, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::counter::Counter;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// What it keeps for gas, in cents.
const KEEP_CENTS: i64 = 6_500;
/// Times the way to the nearest buyer that must be left in the game to buy.
const WAYS_LEFT: i32 = 3;
/// Least gain on a price to buy at, in hundredths.
const GAIN_HUNDREDTHS: i32 = 3;

/// Reckons with the end of the game, where stock counts nothing.
pub struct OutByTheEnd {
    counter: Counter,
    notebook: Notebook,
}

impl MicroStrategy for OutByTheEnd {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            counter: Counter::default(),
            notebook: Notebook::new(grid),
        }
    }
}

impl BehaviourLayer<TruckCreature> for OutByTheEnd {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.counter.learn(heard, body);
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if let Some(deal) = self.counter.in_demand(body) {
            add(proposal, TruckAction::Sell(deal.units));
            return;
        }
        let Some(deal) = self.counter.on_sale(body, KEEP_CENTS) else {
            return;
        };
        let Some((_, steps)) = self.notebook.nearest(buyers_of(deal.commodity), body.corner()) else {
            return;
        };
        let in_time = body.left_in_game_minutes() > WAYS_LEFT * steps.max(4) * STEP_MINUTES;
        let wanted = deal.cents + deal.cents * GAIN_HUNDREDTHS / 100;
        if in_time && best_known_buying_cents(&self.notebook, deal.commodity) > wanted {
            add(proposal, TruckAction::Buy(deal.units));
        }
    }
}
