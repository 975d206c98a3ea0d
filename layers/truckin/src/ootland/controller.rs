//! The controller of one truck: the truck's only interface to the country.
//!
//! It screens every action and ignores what the truck cannot pay for in money, gas or time
//! (Gantchev 2001, 2.1.2.4 and 2.1.2.5). Layers see it through a shared reference, so they can ask
//! but not act; the acting methods are private to the game and reached through the executor alone.
//!
//! Local words: *left* is the time left in the slot. An action that costs time may begin while some
//! is left; what does not fit is taken from the following slots, and `left` is negative until then.
//! A truck that is still on the road, or on the telephone, can neither buy nor sell.

use super::action::{Outcome, Refusal};
use super::clock::Clock;
use super::dealer_manager::Card;
use super::dealers::Commodity;
use super::grid::{Corner, Direction, Grid};
use super::land::Land;
use super::phone;
use super::rules::{
    LITRE_MILLILITRES, LOAD_UNITS_MAX, SLOT_MINUTES, STEP_MILLILITRES, STEP_MINUTES, TANK_MILLILITRES,
    TRUCK_CAPITAL_CENTS,
};

/// What one truck has, as its controller books it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruckBook {
    pub(crate) corner: Corner,
    pub(crate) capital_cents: i64,
    pub(crate) tank_millilitres: i32,
    pub(crate) crates: i32,
    pub(crate) items: i32,
    pub(crate) left_minutes: i32,
}

impl TruckBook {
    pub(crate) fn new(corner: Corner) -> Self {
        Self {
            corner,
            capital_cents: TRUCK_CAPITAL_CENTS,
            tank_millilitres: TANK_MILLILITRES,
            crates: 0,
            items: 0,
            left_minutes: 0,
        }
    }

    /// The truck's money in cents.
    pub fn capital_cents(&self) -> i64 {
        self.capital_cents
    }

    /// Minutes left in the slot; negative when actions have run over.
    pub fn left_minutes(&self) -> i32 {
        self.left_minutes
    }

    /// A new slot: ten minutes more, less what the last actions overran; unused minutes are lost.
    #[inline]
    pub(crate) fn begin_slot(&mut self) {
        self.left_minutes = self.left_minutes.min(0) + SLOT_MINUTES;
    }
}

/// A truck's interface to OOTland for one turn.
pub struct Controller<'turn> {
    book: &'turn mut TruckBook,
    land: &'turn mut Land,
    clock: Clock,
}

/// What a truck may know free of charge.
impl<'turn> Controller<'turn> {
    pub(crate) fn new(book: &'turn mut TruckBook, land: &'turn mut Land, clock: Clock) -> Self {
        Self { book, land, clock }
    }

    /// The size of the country.
    #[inline]
    pub fn grid(&self) -> Grid {
        self.land.grid()
    }

    /// Minutes since the game started.
    #[inline]
    pub fn since_start_minutes(&self) -> i32 {
        self.clock.since_start_minutes() + SLOT_MINUTES - self.book.left_minutes
    }

    /// Minutes left in this slot; negative when actions have run over.
    #[inline]
    pub fn left_in_slot_minutes(&self) -> i32 {
        self.book.left_minutes
    }

    /// Minutes left in the game.
    #[inline]
    pub fn left_in_game_minutes(&self) -> i32 {
        self.clock.remaining_minutes() - SLOT_MINUTES + self.book.left_minutes
    }

    /// Where the truck is.
    #[inline]
    pub fn corner(&self) -> Corner {
        self.book.corner
    }

    /// The truck's money in cents.
    #[inline]
    pub fn capital_cents(&self) -> i64 {
        self.book.capital_cents
    }

    /// Gas in the tank.
    #[inline]
    pub fn tank_millilitres(&self) -> i32 {
        self.book.tank_millilitres
    }

    /// Steps the gas in the tank is good for.
    #[inline]
    pub fn range_steps(&self) -> i32 {
        self.book.tank_millilitres / STEP_MILLILITRES
    }

    /// Whole litres the tank has room for.
    #[inline]
    pub fn tank_room_litres(&self) -> i32 {
        (TANK_MILLILITRES - self.book.tank_millilitres) / LITRE_MILLILITRES
    }

    /// Crates on board.
    #[inline]
    pub fn crates(&self) -> i32 {
        self.book.crates
    }

    /// Items on board.
    #[inline]
    pub fn items(&self) -> i32 {
        self.book.items
    }

    /// What the dealer here advertises.
    #[inline]
    pub fn dealer_here(&self) -> Card {
        self.land.manager(self.book.corner).card()
    }
}

/// What a truck may do; each method screens before anything is spent.
impl Controller<'_> {
    fn screen_time(&self, minutes: i32) -> Result<(), Refusal> {
        if self.book.left_minutes <= 0 {
            Err(Refusal::NoTimeInSlot)
        } else if minutes > self.left_in_game_minutes() {
            Err(Refusal::NoTimeInGame)
        } else {
            Ok(())
        }
    }

    fn screen_trade(&self, units: i32) -> Result<(), Refusal> {
        if self.book.left_minutes < 0 {
            Err(Refusal::NoTimeInSlot)
        } else if units <= 0 {
            Err(Refusal::NothingAsked)
        } else {
            Ok(())
        }
    }

    pub(super) fn drive(&mut self, direction: Direction, steps: u8) -> Result<Outcome, Refusal> {
        if steps == 0 {
            return Err(Refusal::NothingAsked);
        }
        let corner = self
            .grid()
            .after(self.book.corner, direction, steps)
            .ok_or(Refusal::NoRoad)?;
        let minutes = i32::from(steps) * STEP_MINUTES;
        let gas = i32::from(steps) * STEP_MILLILITRES;
        self.screen_time(minutes)?;
        if gas > self.book.tank_millilitres {
            return Err(Refusal::NoGas);
        }
        self.book.left_minutes -= minutes;
        self.book.tank_millilitres -= gas;
        self.book.corner = corner;
        self.land.ledger.gas_burnt_millilitres += i64::from(gas);
        Ok(Outcome::Moved { corner, steps })
    }

    pub(super) fn phone(&mut self, corner: Corner) -> Result<Outcome, Refusal> {
        if usize::from(corner.0) >= self.grid().corners() {
            return Err(Refusal::NoRoad);
        }
        let card = self.land.manager(corner).card();
        let (minutes, cents) = phone::cost(card.kind);
        self.screen_time(minutes)?;
        if cents > self.book.capital_cents {
            return Err(Refusal::NoMoney);
        }
        self.book.left_minutes -= minutes;
        self.book.capital_cents -= cents;
        self.land.ledger.telephone_took_cents += cents;
        Ok(Outcome::Told { corner, card })
    }

    pub(super) fn buy(&mut self, asked: i32) -> Result<Outcome, Refusal> {
        self.screen_trade(asked)?;
        let card = self.dealer_here();
        let commodity = card.kind.sells().ok_or(Refusal::NotTradedHere)?;
        if i64::from(asked) * i64::from(card.selling_cents) > self.book.capital_cents {
            return Err(Refusal::NoMoney);
        }
        if commodity == Commodity::Gas && asked > self.tank_room_litres() {
            return Err(Refusal::TankFull);
        }
        let room = match commodity {
            Commodity::Crates => LOAD_UNITS_MAX - self.book.crates,
            Commodity::Items => LOAD_UNITS_MAX - self.book.items,
            Commodity::Gas => asked,
        };
        let (manager, ledger) = self.land.trade(self.book.corner);
        let (units, cents) = manager.sell(asked.min(room));
        self.book.capital_cents -= cents;
        match commodity {
            Commodity::Crates => {
                self.book.crates += units;
                ledger.producers_took_cents += cents;
            }
            Commodity::Items => self.book.items += units,
            Commodity::Gas => {
                self.book.tank_millilitres += units * LITRE_MILLILITRES;
                ledger.gas_sold_millilitres += i64::from(units) * i64::from(LITRE_MILLILITRES);
            }
        }
        Ok(Outcome::Bought {
            commodity,
            asked,
            units,
            cents,
        })
    }

    pub(super) fn sell(&mut self, offered: i32) -> Result<Outcome, Refusal> {
        self.screen_trade(offered)?;
        let commodity = self.dealer_here().kind.buys().ok_or(Refusal::NotTradedHere)?;
        let on_board = match commodity {
            Commodity::Crates => self.book.crates,
            Commodity::Items => self.book.items,
            Commodity::Gas => return Err(Refusal::NotTradedHere),
        };
        if offered > on_board {
            return Err(Refusal::NoStock);
        }
        let (manager, ledger) = self.land.trade(self.book.corner);
        let (units, cents) = manager.buy(offered);
        self.book.capital_cents += cents;
        match commodity {
            Commodity::Crates => self.book.crates -= units,
            Commodity::Items | Commodity::Gas => {
                self.book.items -= units;
                ledger.consumers_paid_cents += cents;
                ledger.items_consumed += i64::from(units);
            }
        }
        Ok(Outcome::Sold {
            commodity,
            offered,
            units,
            cents,
        })
    }
}
