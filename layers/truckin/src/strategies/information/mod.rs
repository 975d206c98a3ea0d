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

use super::notebook::Notebook;
use super::roads::TruckProposal;
use crate::ootland::chance::Chance;
use crate::ootland::{Corner, Grid};

/// Inhibits trading and leaves gas getting and capital maintenance alone.
fn inhibit_trading(proposal: &mut TruckProposal<'_>) {
    proposal.inhibit(LayerId(2));
}

/// Every corner of the country in an order of chance, to be called once each.
struct CallList(Vec<Corner>);

impl CallList {
    fn new(grid: Grid, chance: &mut Chance) -> CallList {
        let mut corners: Vec<Corner> = (0..grid.corners() as u16).map(Corner).collect();
        chance.shuffle(&mut corners);
        CallList(corners)
    }

    /// The next corner of which nothing is known.
    fn next_unknown(&mut self, notebook: &Notebook) -> Option<Corner> {
        loop {
            let corner = self.0.pop()?;
            if notebook.about(corner).is_none() {
                return Some(corner);
            }
        }
    }
}
