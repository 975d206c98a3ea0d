//! Information gathering: knowing about dealers that are far away. The highest layer; to be heard it
//! inhibits the trading below it, and gas getting only when the tank is no worry.

use super::registry::micro_strategies;

micro_strategies! {
    look_around_only::LookAroundOnly,
    call_the_neighbours::CallTheNeighbours,
    call_before_leaving::CallBeforeLeaving,
    drive_to_see_first::DriveToSeeFirst,
    keep_prices_fresh::KeepPricesFresh,
}

use backplane::LayerId;

use super::roads::TruckProposal;

/// Inhibits trading and leaves gas getting and capital maintenance alone.
fn inhibit_trading(proposal: &mut TruckProposal<'_>) {
    proposal.inhibit(LayerId(2));
}
