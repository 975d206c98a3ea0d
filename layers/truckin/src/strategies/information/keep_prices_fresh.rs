//! Call around for whatever kind is missing, then call the retailer whose prices are the stalest.

use backplane::{BehaviourLayer, Feedback};

use super::{CallList, inhibit_trading};
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, Kind, TruckAction, TruckCreature};
use crate::strategies::MicroStrategy;
use crate::strategies::notebook::Notebook;
use crate::strategies::roads::{TruckProposal, add};

/// Prices older than this are stale: a day.
const STALE_MINUTES: i32 = 24 * 60;
/// Least time between two calls about prices: four hours.
const BETWEEN_CALLS_MINUTES: i32 = 4 * 60;
/// Money below which it does not call, in cents.
const THRIFT_CENTS: i64 = 30_000;

/// Keeps its notes up to date.
pub struct KeepPricesFresh {
    notebook: Notebook,
    to_call: CallList,
    next_call_minute: i32,
}

impl MicroStrategy for KeepPricesFresh {
    fn new(grid: Grid, mut chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            to_call: CallList::new(grid, &mut chance),
            next_call_minute: 0,
        }
    }
}

impl KeepPricesFresh {
    fn stalest_retailer(&self, now: i32) -> Option<Corner> {
        let retailers = self.notebook.ready(Kind::Retailer, 0);
        let stale = retailers.map(|(corner, note)| (note.minute, corner));
        stale
            .min()
            .filter(|(minute, _)| now - minute > STALE_MINUTES)
            .map(|(_, corner)| corner)
    }

    fn missing_kind_call(&mut self) -> Option<Corner> {
        if self.notebook.knows_every_kind() {
            return None;
        }
        self.to_call.next_unknown(&self.notebook)
    }
}

impl BehaviourLayer<TruckCreature> for KeepPricesFresh {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        let now = body.since_start_minutes();
        if body.capital_cents() < THRIFT_CENTS {
            return;
        }
        let call = self.missing_kind_call().or_else(|| {
            let due = now >= self.next_call_minute;
            self.next_call_minute = if due {
                now + BETWEEN_CALLS_MINUTES
            } else {
                self.next_call_minute
            };
            due.then(|| self.stalest_retailer(now)).flatten()
        });
        if let Some(corner) = call {
            inhibit_trading(proposal);
            add(proposal, TruckAction::Phone(corner));
        }
    }
}
