//! Fill up whenever the truck happens to stand at a gas station.
//!
//! Never looks for one, so it lives by luck.

use backplane::{BehaviourLayer, Feedback};

use super::fill_here;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::roads::TruckProposal;

/// Fills up when passing.
pub struct FillWhenPassing;

impl MicroStrategy for FillWhenPassing {
    fn new(_: Grid, _: Chance) -> Self {
        Self
    }
}

impl BehaviourLayer<TruckCreature> for FillWhenPassing {
    fn feedback(&mut self, _: &Feedback<'_, TruckCreature>, _: &Controller<'_>) {}

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        fill_here(proposal, body, i32::MAX);
    }
}
