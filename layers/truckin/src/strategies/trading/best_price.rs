//! Go to the best price known, however far: dearest buyer when loaded, cheapest seller when empty.

use std::cmp::Reverse;

use backplane::{BehaviourLayer, Feedback};

use super::{SHORT_MINUTES, go_or_look, partner_kind};
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::TruckProposal;

/// Goes by price alone.
pub struct BestPrice {
    notebook: Notebook,
    chance: Chance,
}

impl MicroStrategy for BestPrice {
    fn new(grid: Grid, chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            chance,
        }
    }
}

impl BestPrice {
    fn target(&self, body: &Controller<'_>) -> Option<Corner> {
        let here = body.corner();
        let partners = self.notebook.ready(partner_kind(body), SHORT_MINUTES);
        partners
            .filter(|(corner, _)| *corner != here)
            .map(|(corner, note)| (note.card.buying_cents - note.card.selling_cents, corner))
            .max_by_key(|(gain, corner)| (*gain, Reverse(body.grid().steps(here, *corner)), *corner))
            .map(|(_, corner)| corner)
    }
}

impl BehaviourLayer<TruckCreature> for BestPrice {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.range_steps() > 0 {
            let target = self.target(body);
            go_or_look(proposal, body, target, &self.notebook, &mut self.chance);
        }
    }
}
