//! Trading: where to go to make the most of the whole game.

use super::registry::micro_strategies;

micro_strategies! {
    wander::Wander,
    nearest_partner::NearestPartner,
    best_price::BestPrice,
    profit_per_minute::ProfitPerMinute,
    round_trip::RoundTrip,
}

use std::marker::PhantomData;

use backplane::{BehaviourLayer, Feedback};

use super::MicroStrategy;
use super::notebook::{Note, Notebook};
use super::roads::{LEG_STEPS_MAX, TruckProposal, drive_anywhere, drive_to_see, drive_towards};
use crate::ootland::chance::Chance;
use crate::ootland::{Controller, Corner, Grid, Kind, TruckCreature};

/// Minutes for which a dealer that came up short is left out: four hours.
const SHORT_MINUTES: i32 = 240;

/// What kind of dealer is called for: a buyer for what is on board, or else a seller.
fn partner_kind(body: &Controller<'_>) -> Kind {
    if body.items() > 0 {
        Kind::Consumer
    } else if body.crates() > 0 {
        Kind::Retailer
    } else {
        Kind::Producer
    }
}

/// Proposes the way to a target, or, without one, to go and look at more of the country.
fn go_or_look(
    proposal: &mut TruckProposal<'_>,
    body: &Controller<'_>,
    target: Option<Corner>,
    notebook: &Notebook,
    chance: &mut Chance,
) {
    let going = target.is_some_and(|target| drive_towards(proposal, body, target, LEG_STEPS_MAX));
    if !going && !drive_to_see(proposal, body, notebook) {
        drive_anywhere(proposal, body, chance, LEG_STEPS_MAX);
    }
}

/// A rule that says which of the dealers known to go to.
trait Choice: Send + 'static {
    fn target(notebook: &Notebook, body: &Controller<'_>) -> Option<Corner>;
}

/// Goes wherever its rule says, each turn anew.
pub struct GoTo<C> {
    notebook: Notebook,
    chance: Chance,
    rule: PhantomData<C>,
}

impl<C: Choice> MicroStrategy for GoTo<C> {
    fn new(grid: Grid, chance: Chance) -> Self {
        Self {
            notebook: Notebook::new(grid),
            chance,
            rule: PhantomData,
        }
    }
}

impl<C: Choice> BehaviourLayer<TruckCreature> for GoTo<C> {
    fn feedback(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.notebook.learn(heard, body);
    }

    fn go(&mut self, proposal: &mut TruckProposal<'_>, body: &Controller<'_>) {
        if body.range_steps() > 0 {
            let target = C::target(&self.notebook, body);
            go_or_look(proposal, body, target, &self.notebook, &mut self.chance);
        }
    }
}

/// The dealers that are called for now, but the one the truck is at.
fn partners_elsewhere<'n>(
    notebook: &'n Notebook,
    body: &Controller<'_>,
) -> impl Iterator<Item = (Corner, &'n Note)> + use<'n> {
    let here = body.corner();
    let partners = notebook.ready(partner_kind(body), SHORT_MINUTES);
    partners.filter(move |(corner, _)| *corner != here)
}

/// The buyer elsewhere that does best for what is on board, as `worth` weighs the cents it pays and the steps
/// to it.
fn best_buyer_elsewhere(
    notebook: &Notebook,
    body: &Controller<'_>,
    worth: impl Fn(i64, i32) -> i64,
) -> Option<Corner> {
    let loads = [(Kind::Consumer, body.items()), (Kind::Retailer, body.crates())];
    let mut best = None;
    for (kind, units) in loads.into_iter().filter(|(_, units)| *units > 0) {
        for (corner, note) in notebook.ready(kind, SHORT_MINUTES) {
            let cents = i64::from(units) * i64::from(note.card.buying_cents);
            if corner != body.corner() {
                best = best.max(Some((
                    worth(cents, body.grid().steps(body.corner(), corner)),
                    corner,
                )));
            }
        }
    }
    best.map(|(_, corner)| corner)
}
