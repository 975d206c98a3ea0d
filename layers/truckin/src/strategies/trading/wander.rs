//! Drive about at random; whatever dealer turns up is the next partner.

use backplane::{BehaviourLayer, Feedback};

use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::roads::{TruckProposal, drive_anywhere};

/// Goes nowhere in particular.
pub struct Wander {
    chance: Chance,
}

impl MicroStrategy for Wander {
    fn new(_: Grid, chance: Chance) -> Self {
        Self { chance }
    }
}

impl BehaviourLayer<TruckCreature> for Wander {
    fn feedback(&mut self, _: &Feedback<'_, TruckCreature>, _: &Controller<'_>) {}

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.range_steps() > 0 {
            drive_anywhere(proposal, body, &mut self.chance, 2);
        }
    }
}
