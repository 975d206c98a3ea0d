//! Buy at a profit, in lots no larger than buyers have been taking; sell at any price here.

use backplane::{BehaviourLayer, Feedback};

use super::best_known_buying_cents;
use crate::ootland::chance::Chance;
use crate::ootland::{Commodity, Controller, Grid, Outcome, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::counter::Counter;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// What it keeps for gas and a few calls, in cents.
const KEEP_CENTS: i64 = 8_000;
/// Lots it starts with.
const FIRST_CRATES: i32 = 10;
const FIRST_ITEMS: i32 = 400;

/// Sizes its lots by what it could sell before.
pub struct WhatBuyersTake {
    counter: Counter,
    notebook: Notebook,
    lot_crates: i32,
    lot_items: i32,
}

impl MicroStrategy for WhatBuyersTake {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            counter: Counter::default(),
            notebook: Notebook::new(grid),
            lot_crates: FIRST_CRATES,
            lot_items: FIRST_ITEMS,
        }
    }
}

impl BehaviourLayer<TruckCreature> for WhatBuyersTake {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.counter.learn(heard, body);
        self.notebook.learn(heard, body);
        for outcome in heard.selected().map_or(&[][..], |selected| selected.outcomes) {
            let Outcome::Sold {
                commodity,
                offered,
                units,
                ..
            } = *outcome
            else {
                continue;
            };
            let (lot, least) = match commodity {
                Commodity::Crates => (&mut self.lot_crates, FIRST_CRATES / 2),
                Commodity::Items | Commodity::Gas => (&mut self.lot_items, FIRST_ITEMS / 2),
            };
            // All gone: try half as much again. Some left over: halfway to what was taken.
            *lot = if units == offered {
                offered.max(*lot) * 3 / 2
            } else {
                (*lot + units) / 2
            };
            *lot = (*lot).clamp(least, 100 * least);
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if let Some(deal) = self.counter.in_demand(body) {
            add(proposal, TruckAction::Sell(deal.units));
            return;
        }
        let Some(deal) = self.counter.on_sale(body, KEEP_CENTS) else {
            return;
        };
        let (lot, on_board) = match deal.commodity {
            Commodity::Crates => (self.lot_crates, body.crates()),
            Commodity::Items | Commodity::Gas => (self.lot_items, body.items()),
        };
        let units = deal.units.min(lot - on_board);
        if units > 0 && best_known_buying_cents(&self.notebook, deal.commodity) > deal.cents {
            add(proposal, TruckAction::Buy(units));
        }
    }
}
