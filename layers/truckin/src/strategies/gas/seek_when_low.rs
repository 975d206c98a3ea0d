//! Below a fixed mark, drive to the nearest gas station known; fill up when passing half empty.

use backplane::{BehaviourLayer, Feedback};

use super::fill_here;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{LEG_STEPS_MAX, TruckProposal, drive_towards};

/// Steps of gas below which it looks for a station.
const LOW_STEPS: i32 = 18;
/// Litres of room above which it fills up when passing.
const ROOM_LITRES: i32 = 20;

/// Looks for a station below a fixed mark.
pub struct SeekWhenLow {
    notebook: Notebook,
}

impl MicroStrategy for SeekWhenLow {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
        }
    }
}

impl BehaviourLayer<TruckCreature> for SeekWhenLow {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.tank_room_litres() >= ROOM_LITRES && fill_here(proposal, body, i32::MAX) {
            return;
        }
        if body.range_steps() < LOW_STEPS
            && let Some((station, _)) = self.notebook.nearest(Kind::GasStation, body.corner())
        {
            drive_towards(proposal, body, station, LEG_STEPS_MAX);
        }
    }
}
