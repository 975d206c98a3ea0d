//! Buy no litre the rest of the game cannot burn; turn back in time, and ask by telephone when lost.

use backplane::{BehaviourLayer, Feedback};

use super::fill_here;
use crate::ootland::chance::Chance;
use crate::ootland::rules::{CALL_CENTS, STEP_MINUTES};
use crate::ootland::{Controller, Grid, Kind, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{LEG_STEPS_MAX, TruckProposal, add, drive_towards};

/// Steps to spare when turning back.
const SPARE_STEPS: i32 = 2 * LEG_STEPS_MAX as i32 + 1;
/// Steps of gas below which it calls around for a station when it knows none.
const LOST_STEPS: i32 = 25;

/// Reckons with the end of the game, where gas counts nothing.
pub struct EnoughForTheGame {
    notebook: Notebook,
}

impl MicroStrategy for EnoughForTheGame {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
        }
    }
}

impl BehaviourLayer<TruckCreature> for EnoughForTheGame {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        let still_drivable = body.left_in_game_minutes() / STEP_MINUTES;
        let lacking = still_drivable - body.range_steps();
        if lacking <= 0 {
            return;
        }
        if body.tank_room_litres() >= 8 && fill_here(proposal, body, lacking) {
            return;
        }
        match self.notebook.nearest(Kind::GasStation, body.corner()) {
            Some((station, steps)) if body.range_steps() < steps + SPARE_STEPS => {
                drive_towards(proposal, body, station, LEG_STEPS_MAX);
            }
            None if body.range_steps() < LOST_STEPS && body.capital_cents() > 10 * CALL_CENTS => {
                if let Some(unknown) = self.notebook.nearest_unknown(body.corner()) {
                    add(proposal, TruckAction::Phone(unknown));
                }
            }
            Some(_) | None => {}
        }
    }
}
