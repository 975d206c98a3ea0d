//! Commit to a whole trip, from seller to buyer, chosen by gain over time, and see it through.

use backplane::{BehaviourLayer, Feedback};

use super::{SHORT_MINUTES, best_buyer_elsewhere, go_or_look};
use crate::ootland::chance::Chance;
use crate::ootland::rules::STEP_MINUTES;
use crate::ootland::{Controller, Corner, Grid, Kind, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::TruckProposal;

/// Minutes the stops of a trip are reckoned to take.
const STOPS_MINUTES: i64 = 12;
/// Gas for a step, in cents.
const STEP_CENTS: i64 = 100;
/// What a truck reckons with being able to move in one trip.
const LOAD_CRATES: i64 = 20;
const LOAD_ITEMS: i64 = 600;

/// A seller, then a buyer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Trip {
    seller: Corner,
    buyer: Corner,
}

/// Where the truck is in its trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// No trip chosen.
    Idle,
    /// On the way to load.
    Loading(Trip),
    /// On the way to sell.
    Selling(Corner),
}

/// Commits to trips.
pub struct RoundTrip {
    notebook: Notebook,
    chance: Chance,
    stage: Stage,
}

impl MicroStrategy for RoundTrip {
    fn new(grid: Grid, chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            chance,
            stage: Stage::Idle,
        }
    }
}

impl RoundTrip {
    /// The buyer that brings most for what is on board, after the way.
    fn buyer_of_load(&self, body: &Controller<'_>) -> Option<Corner> {
        best_buyer_elsewhere(&self.notebook, body, |cents, steps| {
            cents * 100 / (i64::from(steps * STEP_MINUTES) + STOPS_MINUTES)
        })
    }

    /// The trip with the best gain over its time that still fits in the game.
    fn best_trip(&self, body: &Controller<'_>) -> Option<Trip> {
        let pairs = [
            (Kind::Producer, Kind::Retailer, LOAD_CRATES),
            (Kind::Retailer, Kind::Consumer, LOAD_ITEMS),
        ];
        let mut best = (0, None);
        for (from, to, load) in pairs {
            for (seller, asks) in self.notebook.ready(from, SHORT_MINUTES) {
                let units = (body.capital_cents() / i64::from(asks.card.selling_cents.max(1))).min(load);
                let way = body.grid().steps(body.corner(), seller);
                for (buyer, pays) in self.notebook.ready(to, SHORT_MINUTES) {
                    let steps = i64::from(way + body.grid().steps(seller, buyer));
                    let minutes = steps * i64::from(STEP_MINUTES) + STOPS_MINUTES;
                    let gain = i64::from(pays.card.buying_cents - asks.card.selling_cents) * units
                        - steps * STEP_CENTS;
                    let fits = minutes < i64::from(body.left_in_game_minutes());
                    if fits && gain * 100 / minutes > best.0 {
                        best = (gain * 100 / minutes, Some(Trip { seller, buyer }));
                    }
                }
            }
        }
        best.1
    }

    fn choose(&self, body: &Controller<'_>) -> Stage {
        if let Some(buyer) = self.buyer_of_load(body) {
            return Stage::Selling(buyer);
        }
        self.best_trip(body)
            .filter(|trip| trip.seller != body.corner())
            .map_or(Stage::Idle, Stage::Loading)
    }
}

impl BehaviourLayer<TruckCreature> for RoundTrip {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
        let loaded = body.crates() > 0 || body.items() > 0;
        self.stage = match self.stage {
            Stage::Loading(trip) if body.corner() == trip.seller && loaded => Stage::Selling(trip.buyer),
            Stage::Loading(trip) if body.corner() == trip.seller => Stage::Idle,
            Stage::Selling(buyer) if body.corner() == buyer || !loaded => Stage::Idle,
            stage => stage,
        };
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.range_steps() == 0 {
            return;
        }
        if self.stage == Stage::Idle {
            self.stage = self.choose(body);
        }
        let target = match self.stage {
            Stage::Idle => None,
            Stage::Loading(trip) => Some(trip.seller),
            Stage::Selling(buyer) => Some(buyer),
        };
        go_or_look(proposal, body, target, &self.notebook, &mut self.chance);
    }
}
