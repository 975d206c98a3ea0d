//! The four things a truck can do, and what they come to (Gantchev 2001, 3.2).

use std::fmt;

use backplane::{Action, Creature};

use super::controller::Controller;
use super::dealer_manager::Card;
use super::dealers::Commodity;
use super::grid::{Corner, Direction};

/// The creature the trucks are, for the backplane.
pub struct TruckCreature;

/// One primitive step of a truck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruckAction {
    /// Drive any number of steps in one direction: 6 minutes and 1 litre a step.
    Move(Direction, u8),
    /// Buy so many units from the dealer here: crates, items or litres, whichever it sells.
    Buy(i32),
    /// Sell so many units to the dealer here: crates or items, whichever it buys.
    Sell(i32),
    /// Call the dealer at a corner.
    Phone(Corner),
}

/// What one action came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Arrived, or will have when the minutes are over.
    Moved {
        /// Where.
        corner: Corner,
        /// Steps driven.
        steps: u8,
    },
    /// The dealer sold this many of the units asked for.
    Bought {
        /// What.
        commodity: Commodity,
        /// Units asked for.
        asked: i32,
        /// Units got.
        units: i32,
        /// What they cost together.
        cents: i64,
    },
    /// The dealer bought this many of the units offered.
    Sold {
        /// What.
        commodity: Commodity,
        /// Units offered.
        offered: i32,
        /// Units taken.
        units: i32,
        /// What they brought together.
        cents: i64,
    },
    /// What the dealer called advertises.
    Told {
        /// Where it stands.
        corner: Corner,
        /// What it said.
        card: Card,
    },
    /// The controller ignored the action; nothing was spent.
    Ignored(Refusal),
}

/// Why a controller ignored an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The slot is used up, or the truck has not arrived yet.
    NoTimeInSlot,
    /// It would take longer than the game.
    NoTimeInGame,
    /// Not enough money.
    NoMoney,
    /// Not enough gas.
    NoGas,
    /// No room in the tank.
    TankFull,
    /// The truck does not have what it offers.
    NoStock,
    /// The road ends there, or there is no such corner.
    NoRoad,
    /// The dealer here does not trade that way.
    NotTradedHere,
    /// Nothing, or less than nothing, was asked for.
    NothingAsked,
}

impl Creature for TruckCreature {
    type Body<'turn> = Controller<'turn>;
    type Action = TruckAction;
    type Outcome = Outcome;

    #[inline]
    fn slot_is_used_up(body: &Controller<'_>) -> bool {
        body.left_in_slot_minutes() <= 0
    }
}

impl Action<TruckCreature> for TruckAction {
    fn do_action(self, body: &mut Controller<'_>) -> Outcome {
        let done = match self {
            Self::Move(direction, steps) => body.drive(direction, steps),
            Self::Buy(units) => body.buy(units),
            Self::Sell(units) => body.sell(units),
            Self::Phone(corner) => body.phone(corner),
        };
        done.unwrap_or_else(Outcome::Ignored)
    }
}

impl fmt::Display for TruckAction {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Move(direction, steps) => write!(out, "{direction} {steps}"),
            Self::Buy(units) => write!(out, "buy {units}"),
            Self::Sell(units) => write!(out, "sell {units}"),
            Self::Phone(corner) => write!(out, "phone {}", corner.0),
        }
    }
}
