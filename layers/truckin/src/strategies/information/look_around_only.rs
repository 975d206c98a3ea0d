//! Know only what is seen on the spot; never call, never go out of the way.

use backplane::{BehaviourLayer, Feedback};

use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::roads::TruckProposal;

/// Proposes nothing.
pub struct LookAroundOnly;

impl MicroStrategy for LookAroundOnly {
    fn new(_: Grid, _: Chance) -> Self {
        Self
    }
}

impl BehaviourLayer<TruckCreature> for LookAroundOnly {
    fn feedback(&mut self, _: &Feedback<'_, TruckCreature>, _: &Controller<'_>) {}

    fn go(&mut self, _: &mut TruckProposal<'_>, _: &Controller<'_>) {}
}
