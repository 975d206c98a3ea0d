//! Keep just the gas that the way to the nearest known station needs; search when none is known.

use backplane::{BehaviourLayer, Feedback};

use super::fill_here;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{LEG_STEPS_MAX, TruckProposal, drive_to_see, drive_towards};

/// Steps to spare: a leg away from the station and back, and one step over.
const SPARE_STEPS: i32 = 2 * LEG_STEPS_MAX as i32 + 1;
/// Steps of gas below which it searches when it knows no station.
const SEARCH_STEPS: i32 = 30;

/// Turns back to a station in time.
pub struct ReserveForDistance {
    notebook: Notebook,
}

impl MicroStrategy for ReserveForDistance {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
        }
    }
}

impl BehaviourLayer<TruckCreature> for ReserveForDistance {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.tank_room_litres() >= 10 && fill_here(proposal, body, i32::MAX) {
            return;
        }
        match self.notebook.nearest(Kind::GasStation, body.corner()) {
            Some((station, steps)) if body.range_steps() < steps + SPARE_STEPS => {
                drive_towards(proposal, body, station, LEG_STEPS_MAX);
            }
            None if body.range_steps() < SEARCH_STEPS => {
                drive_to_see(proposal, body, &self.notebook);
            }
            Some(_) | None => {}
        }
    }
}
