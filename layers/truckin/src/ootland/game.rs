//! One game from its seed to its scores.

use std::fmt;

use super::chance::Chance;
use super::clock::Clock;
use super::controller::TruckBook;
use super::grid::Corner;
use super::land::Land;
use super::ledger::{Holdings, LedgerFault};
use super::referee::{Referee, Turn};
use super::rules::{SLOTS_MAX, TANK_MILLILITRES, TRUCK_CAPITAL_CENTS, TRUCKS_MAX};
use super::truck::Truck;
use super::world::World;
use crate::strategies::Chromosome;

/// A game in progress.
pub struct Game {
    pub(super) land: Land,
    pub(super) trucks: Vec<Truck>,
    pub(super) books: Vec<TruckBook>,
    pub(super) referee: Referee,
    opening: Holdings,
}

/// How one truck came out of a game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// Its place in the list of trucks.
    pub seat: usize,
    /// Capital at the end less capital at the start, in cents.
    pub profit_cents: i64,
    /// Gas left.
    pub tank_millilitres: i32,
}

/// A game in which something happened that the rules do not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GameFault {
    /// The slot after which it showed.
    pub slot: u32,
    /// What it is.
    pub what: String,
}

impl fmt::Display for GameFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "slot {}: {}", self.slot, self.what)
    }
}

impl Game {
    /// A game of these trucks in a country drawn from the world with `seed` and `stream`.
    ///
    /// # Panics
    /// When there are more than [`TRUCKS_MAX`] trucks or [`SLOTS_MAX`] slots.
    pub fn new(world: &World, chromosomes: &[Chromosome], slots: u32, seed: u64, stream: u64) -> Self {
        let mut chance = Chance::new(seed, stream);
        let land = world.open(&mut chance.fork(1));
        let mut cabins = chance.fork(2);
        let grid = land.grid();
        let trucks: Vec<Truck> = chromosomes
            .iter()
            .map(|chromosome| Truck::new(*chromosome, grid, &mut cabins))
            .collect();
        Self::of_parts(land, trucks, slots, chance)
    }

    /// A game of a country and trucks made elsewhere.
    ///
    /// # Panics
    /// When there are more than [`TRUCKS_MAX`] trucks or [`SLOTS_MAX`] slots.
    pub fn of_parts(land: Land, trucks: Vec<Truck>, slots: u32, mut chance: Chance) -> Self {
        assert!(trucks.len() <= TRUCKS_MAX, "{} trucks", trucks.len());
        assert!(slots <= SLOTS_MAX, "{slots} slots");
        let mut starts = chance.fork(3);
        let corners = land.grid().corners() as u32;
        let books: Vec<TruckBook> = trucks
            .iter()
            .map(|_| TruckBook::new(Corner(starts.below(corners) as u16)))
            .collect();
        let referee = Referee::new(chance.fork(4), slots, trucks.len());
        let mut game = Self {
            land,
            trucks,
            books,
            referee,
            opening: Holdings::default(),
        };
        game.opening = game.holdings();
        game
    }

    /// What time it is.
    pub fn clock(&self) -> Clock {
        self.referee.clock()
    }

    /// Whether the game is over.
    pub fn is_over(&self) -> bool {
        self.referee.is_over()
    }

    /// The trucks, by seat.
    pub fn trucks(&self) -> &[Truck] {
        &self.trucks
    }

    /// What the trucks have, by seat.
    pub fn books(&self) -> &[TruckBook] {
        &self.books
    }

    /// The country.
    pub fn land(&self) -> &Land {
        &self.land
    }

    /// Plays one slot; nothing once the game is over.
    pub fn play_slot(&mut self) {
        self.play_slot_watched(&mut |_| {});
    }

    /// Plays one slot and tells `watch` of every turn.
    pub fn play_slot_watched(&mut self, watch: &mut impl FnMut(Turn)) {
        if !self.is_over() {
            self.referee
                .play_slot(&mut self.land, &mut self.trucks, &mut self.books, watch);
        }
    }

    /// Plays to the end. With `check`, conservation and limits are checked after every slot.
    ///
    /// # Errors
    /// With `check`, the first slot after which the books do not add up.
    pub fn play(&mut self, check: bool) -> Result<(), GameFault> {
        while !self.is_over() {
            self.play_slot();
            if check {
                self.check()?;
            }
        }
        Ok(())
    }

    /// Checks that money and goods are conserved and that nobody holds less than nothing or more gas
    /// than a tank.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn check(&self) -> Result<(), GameFault> {
        let slot = self.clock().slot;
        let fault = |what: String| GameFault { slot, what };
        self.land
            .ledger
            .check(&self.opening, &self.holdings())
            .map_err(|wrong: LedgerFault| fault(wrong.to_string()))?;
        match self
            .books
            .iter()
            .position(|book| book.tank_millilitres > TANK_MILLILITRES)
        {
            Some(seat) => Err(fault(format!("the tank of truck {seat} holds more than it can"))),
            None => Ok(()),
        }
    }

    /// How the trucks stand now, by seat.
    pub fn standings(&self) -> impl Iterator<Item = Standing> + '_ {
        self.books.iter().enumerate().map(|(seat, book)| Standing {
            seat,
            profit_cents: book.capital_cents - TRUCK_CAPITAL_CENTS,
            tank_millilitres: book.tank_millilitres,
        })
    }

    fn holdings(&self) -> Holdings {
        let mut sum = self.land.holdings();
        for book in &self.books {
            let (crates, items) = (i64::from(book.crates), i64::from(book.items));
            let gas = i64::from(book.tank_millilitres);
            sum.cents += book.capital_cents;
            sum.crates += crates;
            sum.items += items;
            sum.gas_millilitres += gas;
            sum.least = sum.least.min(book.capital_cents).min(crates).min(items).min(gas);
        }
        sum
    }
}
