//! Take what is on board to the nearest dealer that buys it; empty, go to the nearest producer.

use backplane::{BehaviourLayer, Feedback};

use super::{SHORT_MINUTES, go_or_look, partner_kind};
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::TruckProposal;

/// Goes by distance alone.
pub struct NearestPartner {
    notebook: Notebook,
    chance: Chance,
}

impl MicroStrategy for NearestPartner {
    fn new(grid: Grid, chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            chance,
        }
    }
}

impl NearestPartner {
    fn target(&self, body: &Controller<'_>) -> Option<Corner> {
        let here = body.corner();
        let partners = self
            .notebook
            .ready(partner_kind(body), SHORT_MINUTES)
            .map(|(corner, _)| corner);
        partners
            .filter(|corner| *corner != here)
            .min_by_key(|corner| (body.grid().steps(here, *corner), *corner))
    }
}

impl BehaviourLayer<TruckCreature> for NearestPartner {
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
