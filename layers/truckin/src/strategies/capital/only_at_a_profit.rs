//! Buy only what a known buyer pays more for, sell only above what was paid.

use backplane::{BehaviourLayer, Feedback};

use super::best_known_buying_cents;
use crate::ootland::chance::Chance;
use crate::ootland::{Commodity, Controller, Grid, Outcome, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::counter::Counter;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// What it keeps for gas, in cents.
const KEEP_CENTS: i64 = 6_500;

/// Compares every price with the one on the other side.
pub struct OnlyAtAProfit {
    counter: Counter,
    notebook: Notebook,
    paid_for_crate_cents: i32,
    paid_for_item_cents: i32,
}

impl MicroStrategy for OnlyAtAProfit {
    fn new(grid: Grid, _: Chance) -> Self {
        let (counter, notebook) = (Counter::default(), Notebook::new(grid));
        Self {
            counter,
            notebook,
            paid_for_crate_cents: 0,
            paid_for_item_cents: 0,
        }
    }
}

impl OnlyAtAProfit {
    fn paid(&self, commodity: Commodity) -> i32 {
        match commodity {
            Commodity::Crates => self.paid_for_crate_cents,
            Commodity::Items | Commodity::Gas => self.paid_for_item_cents,
        }
    }
}

impl BehaviourLayer<TruckCreature> for OnlyAtAProfit {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.counter.learn(heard, body);
        self.notebook.learn(heard, body);
        for outcome in heard.selected().map_or(&[][..], |selected| selected.outcomes) {
            if let Outcome::Bought {
                commodity,
                units,
                cents,
                ..
            } = *outcome
                && units > 0
            {
                let each = (cents / i64::from(units)) as i32;
                match commodity {
                    Commodity::Crates => self.paid_for_crate_cents = each,
                    Commodity::Items => self.paid_for_item_cents = each,
                    Commodity::Gas => {}
                }
            }
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        let in_demand = self
            .counter
            .in_demand(body)
            .filter(|deal| deal.cents > self.paid(deal.commodity));
        if let Some(deal) = in_demand {
            add(proposal, TruckAction::Sell(deal.units));
            return;
        }
        let on_sale = self.counter.on_sale(body, KEEP_CENTS);
        if let Some(deal) = on_sale
            && best_known_buying_cents(&self.notebook, deal.commodity) > deal.cents
        {
            add(proposal, TruckAction::Buy(deal.units));
        }
    }
}
