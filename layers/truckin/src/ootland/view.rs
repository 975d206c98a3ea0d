//! A game as those who watch see it: everything on the table, ready for JSON.
//!
//! Watching never changes a game. Trucks have no way to this.

use serde::Serialize;

use super::action::Outcome;
use super::dealers::Kind;
use super::game::Game;
use super::grid::Corner;
use super::rules::STEP_MINUTES;
use crate::strategies::SLOTS;

/// The whole game after a slot.
#[derive(Clone, Debug, Serialize)]
pub struct GameView {
    /// Slots played.
    pub slot: u32,
    /// Slots in the game.
    pub slots: u32,
    /// Roads running north and south.
    pub avenues: u16,
    /// Roads running east and west.
    pub streets: u16,
    /// Dealers that trade something, by corner.
    pub dealers: Vec<DealerView>,
    /// Trucks, by seat.
    pub trucks: Vec<TruckView>,
}

/// One dealer.
#[derive(Clone, Debug, Serialize)]
pub struct DealerView {
    /// Counted from 0 in the west.
    pub avenue: u16,
    /// Counted from 0 in the south.
    pub street: u16,
    /// `producer`, `retailer`, `consumer` or `gas_station`.
    pub kind: &'static str,
    /// Price it pays for a unit in cents; 0 when it buys nothing.
    pub buying_cents: i32,
    /// Price it asks for a unit in cents; 0 when it sells nothing.
    pub selling_cents: i32,
    /// Crates in stock.
    pub crates: i32,
    /// Items in stock.
    pub items: i32,
    /// Items it would buy now.
    pub wanted_items: i32,
    /// Its own money in cents.
    pub capital_cents: i64,
}

/// One truck.
#[derive(Clone, Debug, Serialize)]
pub struct TruckView {
    /// Its place in the list.
    pub seat: usize,
    /// Its name.
    pub chromosome: String,
    /// Where it is, or is on its way to.
    pub avenue: u16,
    /// Where it is, or is on its way to.
    pub street: u16,
    /// Minutes until it is free again; 0 when it is.
    pub busy_minutes: i32,
    /// Steps still to drive, if it is driving.
    pub steps_to_go: i32,
    /// Its money in cents.
    pub capital_cents: i64,
    /// Gas in the tank.
    pub tank_millilitres: i32,
    /// Crates on board.
    pub crates: i32,
    /// Items on board.
    pub items: i32,
    /// The layer whose plan was carried out last, by rank; nothing when it waits.
    pub holder: Option<u8>,
    /// All layers, lowest first.
    pub layers: Vec<LayerView>,
    /// What came of the actions of the plan.
    pub outcomes: Vec<String>,
}

/// One layer of a truck.
#[derive(Clone, Debug, Serialize)]
pub struct LayerView {
    /// The layer's subgoal.
    pub slot: &'static str,
    /// The micro-strategy in it.
    pub strategy: &'static str,
    /// Whether a layer above inhibited it.
    pub inhibited: bool,
    /// The plan it proposed, action by action.
    pub plan: Vec<String>,
}

impl GameView {
    /// What there is to see of a game now.
    pub fn of(game: &Game) -> Self {
        let land = game.land();
        let grid = land.grid();
        let corners = (0..grid.corners() as u16).map(Corner);
        let trading = corners.filter(|corner| land.manager(*corner).kind() != Kind::Idle);
        Self {
            slot: game.clock().slot,
            slots: game.clock().slots,
            avenues: grid.avenues,
            streets: grid.streets,
            dealers: trading.map(|corner| DealerView::of(game, corner)).collect(),
            trucks: (0..game.trucks().len())
                .map(|seat| TruckView::of(game, seat))
                .collect(),
        }
    }
}

impl DealerView {
    fn of(game: &Game, corner: Corner) -> Self {
        let manager = game.land().manager(corner);
        let (avenue, street) = game.land().grid().place(corner);
        Self {
            avenue,
            street,
            kind: manager.kind().name(),
            buying_cents: manager.buying_cents(),
            selling_cents: manager.selling_cents(),
            crates: manager.crates(),
            items: manager.items(),
            wanted_items: manager.wanted_items(),
            capital_cents: manager.capital_cents(),
        }
    }
}

impl TruckView {
    fn of(game: &Game, seat: usize) -> Self {
        let (truck, book) = (&game.trucks()[seat], &game.books()[seat]);
        let (avenue, street) = game.land().grid().place(book.corner);
        let backplane = truck.backplane();
        let selected = backplane.selected();
        let busy_minutes = (-book.left_minutes).max(0);
        let drove = selected.as_ref().is_some_and(|selected| {
            selected
                .outcomes
                .iter()
                .any(|outcome| matches!(outcome, Outcome::Moved { .. }))
        });
        let layers = SLOTS.iter().zip(truck.chromosome().genes()).enumerate();
        Self {
            seat,
            chromosome: truck.chromosome().to_string(),
            avenue,
            street,
            busy_minutes,
            steps_to_go: if drove {
                (busy_minutes + STEP_MINUTES - 1) / STEP_MINUTES
            } else {
                0
            },
            capital_cents: book.capital_cents,
            tank_millilitres: book.tank_millilitres,
            crates: book.crates,
            items: book.items,
            holder: selected.as_ref().map(|selected| selected.layer.0),
            layers: layers
                .take(backplane.layers())
                .map(|(rank, (slot, gene))| {
                    let control = backplane.control(backplane::LayerId(rank as u8));
                    LayerView {
                        slot: slot.name,
                        strategy: slot.alleles[usize::from(gene)].name,
                        inhibited: control.is_inhibited(),
                        plan: control.plan().actions().iter().map(ToString::to_string).collect(),
                    }
                })
                .collect(),
            outcomes: selected.map_or_else(Vec::new, |selected| {
                selected
                    .outcomes
                    .iter()
                    .map(|outcome| format!("{outcome:?}"))
                    .collect()
            }),
        }
    }
}
