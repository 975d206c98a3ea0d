//! Weigh each station's price against the way to it; fill up where it is cheap, sip where it is dear.

use backplane::{BehaviourLayer, Feedback};

use super::fill_here;
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{LEG_STEPS_MAX, TruckProposal, drive_to_see, drive_towards};

/// Steps of gas below which it goes for a station.
const LOW_STEPS: i32 = 24;
/// Litres a visit is reckoned to buy when prices are weighed.
const VISIT_LITRES: i32 = 30;
/// Litres it sips at a dear station.
const SIP_LITRES: i32 = 12;
/// What a step of detour is reckoned to cost in lost time, in cents, besides its gas.
const STEP_CENTS: i32 = 60;

/// Buys gas where it is cheap.
pub struct CheapestInReach {
    notebook: Notebook,
    cheapest_cents: i32,
}

impl MicroStrategy for CheapestInReach {
    fn new(grid: Grid, _: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            cheapest_cents: i32::MAX,
        }
    }
}

impl CheapestInReach {
    fn best_station(&self, body: &Controller<'_>) -> Option<Corner> {
        let reach = body.range_steps();
        let stations = self
            .notebook
            .ready(Kind::GasStation, 0)
            .filter_map(|(corner, note)| {
                let steps = body.grid().steps(body.corner(), corner);
                let litre = note.card.selling_cents;
                (steps <= reach).then_some((litre * VISIT_LITRES + steps * (litre + STEP_CENTS), corner))
            });
        stations.min().map(|(_, corner)| corner)
    }
}

impl BehaviourLayer<TruckCreature> for CheapestInReach {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
        let stations = self.notebook.ready(Kind::GasStation, 0);
        self.cheapest_cents = stations
            .map(|(_, note)| note.card.selling_cents)
            .min()
            .unwrap_or(i32::MAX);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        let here = body.dealer_here();
        if here.kind == Kind::GasStation {
            let cheap = here.selling_cents <= self.cheapest_cents + 5;
            let litres = if cheap { i32::MAX } else { SIP_LITRES };
            let wants = if cheap {
                body.tank_room_litres() >= 5
            } else {
                body.range_steps() < LOW_STEPS
            };
            if wants && fill_here(proposal, body, litres) {
                return;
            }
        }
        if body.range_steps() < LOW_STEPS {
            match self.best_station(body) {
                Some(station) => drive_towards(proposal, body, station, LEG_STEPS_MAX),
                None => drive_to_see(proposal, body, &self.notebook),
            };
        }
    }
}
