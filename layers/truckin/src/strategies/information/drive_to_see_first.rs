//! Drive from corner to corner until every kind of dealer has been seen twice, and then trade.

use backplane::{BehaviourLayer, Feedback};

use super::inhibit_trading;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, drive_to_see};

/// Dealers of each kind it wants to have seen.
const ENOUGH: usize = 2;

/// Explores first.
pub struct DriveToSeeFirst {
    notebook: Notebook,
    done: bool,
}

impl MicroStrategy for DriveToSeeFirst {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            done: false,
        }
    }
}

impl BehaviourLayer<TruckCreature> for DriveToSeeFirst {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        if !self.done {
            self.notebook.learn(heard, body);
            self.done = Kind::ALL[1..]
                .iter()
                .all(|kind| self.notebook.known(*kind).len() >= ENOUGH);
        }
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if !self.done && drive_to_see(proposal, body, &self.notebook) {
            inhibit_trading(proposal);
        }
    }
}
