//! Trading: where to go to make the most of the whole game.

use super::registry::micro_strategies;

micro_strategies! {
    wander::Wander,
    nearest_partner::NearestPartner,
    best_price::BestPrice,
    profit_per_minute::ProfitPerMinute,
    round_trip::RoundTrip,
}

use super::notebook::Notebook;
use super::roads::{LEG_STEPS_MAX, TruckProposal, drive_anywhere, drive_to_see, drive_towards};
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Kind};

/// Minutes for which a dealer that came up short is left out: four hours.
const SHORT_MINUTES: i32 = 240;

/// What kind of dealer is called for: a buyer for what is on board, or else a seller.
fn partner_kind(body: &Controller<'_>) -> Kind {
    if body.items() > 0 {
        Kind::Consumer
    } else if body.crates() > 0 {
        Kind::Retailer
    } else {
        Kind::Producer
    }
}

/// Proposes the way to a target, or, without one, to go and look at more of the country.
fn go_or_look(
    proposal: &mut TruckProposal<'_>,
    body: &Controller<'_>,
    target: Option<Corner>,
    notebook: &Notebook,
    chance: &mut Chance,
) {
    let going = target.is_some_and(|target| drive_towards(proposal, body, target, LEG_STEPS_MAX));
    if !going && !drive_to_see(proposal, body, notebook) {
        drive_anywhere(proposal, body, chance, LEG_STEPS_MAX);
    }
}
