//! The manager of one dealer: keeps it honest, its capital and stock never negative.
//!
//! A dealer and every truck's controller reach a dealer's books only through these methods
//! (Gantchev 2001, 2.1.2.6). Advertised prices are honoured; a quantity may be cut.

use super::dealers::{Commodity, Kind};
use super::rules::{CRATE_CENTS_MAX, ITEMS_PER_CRATE, LITRE_MILLILITRES, UNIT_CENTS_MAX};

/// What a dealer advertises: the same on the spot and over the telephone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Card {
    /// The kind of dealer, and so the commodities.
    pub kind: Kind,
    /// What it pays for a unit of what it buys, in cents; 0 when it buys nothing.
    pub buying_cents: i32,
    /// What it asks for a unit of what it sells, in cents; 0 when it sells nothing.
    pub selling_cents: i32,
}

/// A dealer's stock and limits as its game opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Opening {
    /// What it advertises.
    pub card: Card,
    /// Money of its own; only retailers and gas stations have any.
    pub capital_cents: i64,
    /// Crates in stock.
    pub crates: i32,
    /// Items in stock.
    pub items: i32,
    /// Crates it has room for.
    pub crate_storage: i32,
    /// Items it has room for, or, for a consumer, goes on wanting.
    pub item_storage: i32,
}

impl Opening {
    /// Of a dealer who advertises this and has nothing, nor room for anything.
    pub(crate) fn of(card: Card) -> Self {
        Self {
            card,
            capital_cents: 0,
            crates: 0,
            items: 0,
            crate_storage: 0,
            item_storage: 0,
        }
    }
}

/// Keeps one dealer's books.
#[derive(Clone, Debug)]
pub struct Manager {
    books: Opening,
    wanted_items: i32,
    bought_units: i64,
    sold_units: i64,
}

impl Manager {
    /// Opens the books.
    pub fn new(opening: Opening) -> Self {
        Self {
            books: opening,
            wanted_items: 0,
            bought_units: 0,
            sold_units: 0,
        }
    }

    /// The books of a dealer who advertises this and has nothing.
    pub(crate) fn of_card(card: Card) -> Self {
        Self::new(Opening::of(card))
    }

    /// The books of a dealer who trades nothing.
    pub(crate) fn idle() -> Self {
        Self::of_card(Card {
            kind: Kind::Idle,
            buying_cents: 0,
            selling_cents: 0,
        })
    }

    /// What the dealer advertises now.
    #[inline]
    pub fn card(&self) -> Card {
        self.books.card
    }

    /// The kind of dealer.
    pub fn kind(&self) -> Kind {
        self.books.card.kind
    }

    /// The dealer's own money in cents.
    pub fn capital_cents(&self) -> i64 {
        self.books.capital_cents
    }

    /// Crates in stock.
    pub fn crates(&self) -> i32 {
        self.books.crates
    }

    /// Items in stock.
    pub fn items(&self) -> i32 {
        self.books.items
    }

    /// Items a consumer would take now.
    pub fn wanted_items(&self) -> i32 {
        self.wanted_items
    }

    /// Units bought from trucks since the start.
    pub fn bought_units(&self) -> i64 {
        self.bought_units
    }

    /// Units sold to trucks since the start.
    pub fn sold_units(&self) -> i64 {
        self.sold_units
    }

    /// Room for crates.
    pub fn crate_storage(&self) -> i32 {
        self.books.crate_storage
    }

    /// Room for items.
    pub fn item_storage(&self) -> i32 {
        self.books.item_storage
    }

    /// What it pays for a unit, in cents.
    pub fn buying_cents(&self) -> i32 {
        self.books.card.buying_cents
    }

    /// What it asks for a unit, in cents.
    pub fn selling_cents(&self) -> i32 {
        self.books.card.selling_cents
    }

    /// Puts up new prices. Only retailers set theirs; a price below one cent is put up as
    /// one cent, one beyond the largest as the largest.
    pub fn set_prices(&mut self, buying_cents: i32, selling_cents: i32) {
        if self.kind() == Kind::Retailer {
            self.books.card.buying_cents = buying_cents.clamp(1, CRATE_CENTS_MAX);
            self.books.card.selling_cents = selling_cents.clamp(1, UNIT_CENTS_MAX);
        }
    }

    /// Puts newly made crates into a producer's yard; returns how many there was room for.
    pub fn take_in_crates(&mut self, made: i32) -> i32 {
        let kept = made.min(self.books.crate_storage - self.books.crates).max(0);
        self.books.crates += kept;
        kept
    }

    /// Adds to what a consumer wants, up to its storage.
    pub fn want_items(&mut self, wanted: i32) {
        self.wanted_items = (self.wanted_items + wanted).min(self.books.item_storage);
    }

    /// Unpacks one crate if there is one and room for its items; returns the crates unpacked.
    pub fn unpack(&mut self) -> i32 {
        let room = self.books.item_storage - self.books.items;
        if self.books.crates == 0 || room < ITEMS_PER_CRATE {
            return 0;
        }
        self.books.crates -= 1;
        self.books.items += ITEMS_PER_CRATE;
        1
    }

    /// How many units the dealer would sell of what it sells; gas in litres, without limit.
    pub fn on_sale(&self) -> i32 {
        match self.kind().sells() {
            Some(Commodity::Crates) => self.books.crates,
            Some(Commodity::Items) => self.books.items,
            Some(Commodity::Gas) => i32::MAX / LITRE_MILLILITRES,
            None => 0,
        }
    }

    /// How many units the dealer would take: what it has room for, wants, and can pay.
    pub fn in_demand(&self) -> i32 {
        match self.kind().buys() {
            Some(Commodity::Crates) => {
                let room = self.books.crate_storage - self.books.crates;
                let affordable = self.books.capital_cents / i64::from(self.books.card.buying_cents);
                i64::from(room).min(affordable) as i32
            }
            Some(Commodity::Items) => self.wanted_items,
            Some(Commodity::Gas) | None => 0,
        }
    }

    /// Sells up to `quantity` units to a truck; returns units and cents.
    pub fn sell(&mut self, quantity: i32) -> (i32, i64) {
        let sold = quantity.min(self.on_sale()).max(0);
        let cents = i64::from(sold) * i64::from(self.selling_cents());
        self.sold_units += i64::from(sold);
        match self.kind() {
            Kind::Producer => self.books.crates -= sold,
            Kind::Retailer => {
                self.books.items -= sold;
                self.books.capital_cents += cents;
            }
            Kind::GasStation => self.books.capital_cents += cents,
            Kind::Idle | Kind::Consumer => {}
        }
        (sold, cents)
    }

    /// Buys up to `quantity` units from a truck; returns units and cents.
    pub fn buy(&mut self, quantity: i32) -> (i32, i64) {
        let bought = quantity.min(self.in_demand()).max(0);
        let cents = i64::from(bought) * i64::from(self.buying_cents());
        self.bought_units += i64::from(bought);
        match self.kind() {
            Kind::Retailer => {
                self.books.crates += bought;
                self.books.capital_cents -= cents;
            }
            Kind::Consumer => self.wanted_items -= bought,
            Kind::Idle | Kind::Producer | Kind::GasStation => {}
        }
        (bought, cents)
    }
}
