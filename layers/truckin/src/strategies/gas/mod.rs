//! Gas getting: keeping the ability to move. The lowest layer, so it goes first.

use super::registry::micro_strategies;

micro_strategies! {
    fill_when_passing::FillWhenPassing,
    seek_when_low::SeekWhenLow,
    reserve_for_distance::ReserveForDistance,
    cheapest_in_reach::CheapestInReach,
    enough_for_the_game::EnoughForTheGame,
}

use super::roads::{TruckProposal, add};
use crate::ootland::{Controller, Kind, TruckAction};

/// Proposes to buy up to `litres` at the station here, as far as tank and money go; returns false,
/// proposing nothing, when this is no station or nothing can be bought.
fn fill_here(proposal: &mut TruckProposal<'_>, body: &Controller<'_>, litres: i32) -> bool {
    let card = body.dealer_here();
    if card.kind != Kind::GasStation {
        return false;
    }
    let affordable = body.capital_cents() / i64::from(card.selling_cents.max(1));
    let litres = i64::from(litres.min(body.tank_room_litres())).min(affordable) as i32;
    if litres > 0 {
        add(proposal, TruckAction::Buy(litres));
    }
    litres > 0
}
