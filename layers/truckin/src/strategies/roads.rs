//! Getting about: how layers turn "go there" into actions.

use backplane::Proposal;

use super::notebook::Notebook;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Direction, TruckAction, TruckCreature};

/// Steps in one go at most, so that every layer gets a word in every 24 minutes.
pub const LEG_STEPS_MAX: u8 = 4;

/// A truck layer's proposal.
pub type TruckProposal<'a> = Proposal<'a, TruckCreature>;

/// Adds an action to a plan that this layer has just begun.
///
/// # Panics
/// When the plan is full: a micro-strategy proposes a few actions at a time.
pub fn add(proposal: &mut TruckProposal<'_>, action: TruckAction) {
    proposal.add(action).expect("a plan of a few actions");
}

/// Proposes the next leg towards a corner; returns false, proposing nothing, when already there or
/// out of gas.
pub fn drive_towards(
    proposal: &mut TruckProposal<'_>,
    body: &Controller<'_>,
    target: Corner,
    steps_max: u8,
) -> bool {
    let Some((direction, steps)) = body.grid().leg(body.corner(), target) else {
        return false;
    };
    let steps = i32::from(steps.min(steps_max)).min(body.range_steps());
    if steps > 0 {
        add(proposal, TruckAction::Move(direction, steps as u8));
    }
    steps > 0
}

/// Proposes a few steps in a direction drawn at random among those the road goes on in.
pub fn drive_anywhere(
    proposal: &mut TruckProposal<'_>,
    body: &Controller<'_>,
    chance: &mut Chance,
    steps_max: u8,
) {
    let steps = 1 + chance.below(u32::from(steps_max)) as u8;
    let first = chance.below(4) as usize;
    let directions = (0..4).map(|turn| Direction::ALL[(first + turn) % 4]);
    let mut open =
        directions.filter(|direction| body.grid().after(body.corner(), *direction, steps).is_some());
    if let Some(direction) = open.next() {
        add(proposal, TruckAction::Move(direction, steps));
    }
}

/// Proposes to go and see the nearest corner nothing is known of, step by step; returns false when
/// every corner is known or the tank is empty.
pub fn drive_to_see(proposal: &mut TruckProposal<'_>, body: &Controller<'_>, notebook: &Notebook) -> bool {
    notebook
        .nearest_unknown(body.corner())
        .is_some_and(|unknown| drive_towards(proposal, body, unknown, 1))
}
