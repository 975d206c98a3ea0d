//! Loaded, go where the load brings most per minute of the way; empty, where the next load will.

use backplane::{BehaviourLayer, Feedback};

use super::{SHORT_MINUTES, best_buyer_elsewhere, go_or_look};
use crate::ootland::chance::Chance;
use crate::ootland::rules::{LOAD_UNITS_MAX, STEP_MINUTES};
use crate::ootland::{Controller, Corner, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::TruckProposal;

/// Minutes a stop is reckoned to take besides the way.
const STOP_MINUTES: i32 = 6;
/// Gas for a step, in cents.
const STEP_CENTS: i64 = 100;

/// Weighs price against way.
pub struct ProfitPerMinute {
    notebook: Notebook,
    chance: Chance,
    target: Option<Corner>,
}

impl MicroStrategy for ProfitPerMinute {
    fn new(grid: Grid, chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            chance,
            target: None,
        }
    }
}

impl ProfitPerMinute {
    fn per_minute(cents: i64, steps: i32) -> i64 {
        let minutes = i64::from(steps * STEP_MINUTES + STOP_MINUTES);
        (cents - i64::from(steps) * STEP_CENTS) * 100 / minutes
    }

    /// The buyer whose price for the load, over the way there, is best.
    fn best_buyer(&self, body: &Controller<'_>) -> Option<Corner> {
        best_buyer_elsewhere(&self.notebook, body, Self::per_minute)
    }

    /// The seller from which a full load, sold at the best buyer of it, brings most per minute.
    fn best_seller(&self, body: &Controller<'_>) -> Option<Corner> {
        let pairs = [(Kind::Producer, Kind::Retailer), (Kind::Retailer, Kind::Consumer)];
        let mut best = (0, None);
        for (from, to) in pairs {
            for (seller, asks) in self.notebook.ready(from, SHORT_MINUTES) {
                let units = (body.capital_cents() / i64::from(asks.card.selling_cents.max(1)))
                    .min(i64::from(LOAD_UNITS_MAX));
                let way = body.grid().steps(body.corner(), seller);
                for (buyer, pays) in self.notebook.ready(to, SHORT_MINUTES) {
                    let gain = i64::from(pays.card.buying_cents - asks.card.selling_cents);
                    let steps = way + body.grid().steps(seller, buyer);
                    let rate = Self::per_minute(gain * units, steps);
                    if rate > best.0 && seller != body.corner() {
                        best = (rate, Some(seller));
                    }
                }
            }
        }
        best.1
    }
}

impl BehaviourLayer<TruckCreature> for ProfitPerMinute {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
        if !heard.was_mine() || self.target == Some(body.corner()) {
            self.target = None;
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.range_steps() == 0 {
            return;
        }
        if self.target.is_none() {
            self.target = self.best_buyer(body).or_else(|| self.best_seller(body));
        }
        go_or_look(proposal, body, self.target, &self.notebook, &mut self.chance);
    }
}
