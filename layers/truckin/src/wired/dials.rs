//! The dials in a truck's cab: what a controller tells free of charge, as one message.
//!
//! On the wire: slot, slots in the game, number of the last order answered, minutes left in the slot, corner,
//! capital (cents), tank (millilitres), crates, items, and of the dealer here its kind, buying and selling price.
//! Must never show a dealer elsewhere: that is what the telephone is for.

use ipc::message::Map;

use super::order::{card_of, map_of};
use crate::ootland::{Card, Clock, Controller, Corner, Grid, Land, TruckBook};

/// The words of one message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// What time it is.
    pub clock: Clock,
    /// The last order that was answered; 0 before the first.
    pub answered: u64,
    /// What the truck has and where it is.
    pub book: TruckBook,
    /// What the dealer here advertises.
    pub here: Card,
}

impl Reading {
    /// As a message.
    pub fn pack(&self) -> Map {
        let book = &self.book;
        map_of(&[
            f64::from(self.clock.slot),
            f64::from(self.clock.slots),
            self.answered as f64,
            f64::from(book.left_minutes),
            f64::from(book.corner.0),
            book.capital_cents as f64,
            f64::from(book.tank_millilitres),
            f64::from(book.crates),
            f64::from(book.items),
            f64::from(self.here.kind as u8),
            f64::from(self.here.buying_cents),
            f64::from(self.here.selling_cents),
        ])
    }

    /// The reading in a message; nothing when the corner is outside `grid` or the dealer of no kind.
    pub fn of(map: &Map, grid: Grid) -> Option<Self> {
        let word = map.ranges;
        let corner = Corner(word[4] as u16);
        let here = card_of([word[9], word[10], word[11]])?;
        let on_the_map = usize::from(corner.0) < grid.corners();
        on_the_map.then_some(Self {
            clock: Clock {
                slot: word[0] as u32,
                slots: word[1] as u32,
            },
            answered: word[2] as u64,
            book: TruckBook {
                corner,
                capital_cents: word[5] as i64,
                tank_millilitres: word[6] as i32,
                crates: word[7] as i32,
                items: word[8] as i32,
                left_minutes: word[3] as i32,
            },
            here,
        })
    }
}

/// The dials, read through a [`Controller`] of their own by layers that know no other country: it has nobody in
/// it but the dealer here.
#[derive(Clone, Debug)]
pub struct Dials {
    land: Land,
    book: TruckBook,
    clock: Clock,
}

impl Dials {
    /// Dials that nobody has set yet, for a country of this size. Nothing allocates afterwards.
    pub fn new(grid: Grid) -> Self {
        Self {
            land: Land::empty(grid),
            book: TruckBook::new(Corner(0)),
            clock: Clock { slot: 0, slots: 0 },
        }
    }

    /// Shows a reading.
    pub fn set(&mut self, reading: &Reading) {
        self.land.close(self.book.corner);
        self.book = reading.book;
        self.clock = reading.clock;
        self.land.advertise(self.book.corner, reading.here);
    }

    /// The controller that shows them.
    pub fn controller(&mut self) -> Controller<'_> {
        Controller::new(&mut self.book, &mut self.land, self.clock)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ootland::Kind;

    #[test]
    fn a_reading_goes_round_and_shows_nothing_but_the_dealer_here() {
        let grid = Grid {
            avenues: 10,
            streets: 10,
        };
        let at = |corner| Reading {
            clock: Clock { slot: 7, slots: 900 },
            answered: 12,
            book: TruckBook {
                left_minutes: -2,
                ..TruckBook::new(Corner(corner))
            },
            here: Card {
                kind: Kind::GasStation,
                buying_cents: 0,
                selling_cents: 97,
            },
        };
        let reading = at(42);
        assert_eq!(Reading::of(&reading.pack(), grid), Some(reading));
        assert_eq!(Reading::of(&at(100).pack(), grid), None, "outside");
        let mut dials = Dials::new(grid);
        dials.set(&reading);
        dials.set(&at(43));
        assert_eq!(dials.controller().dealer_here(), reading.here);
        assert_eq!(dials.controller().left_in_slot_minutes(), -2);
        assert_eq!(dials.controller().left_in_game_minutes(), 8_930 - 12);
        assert_eq!(dials.land.manager(Corner(42)).kind(), Kind::Idle, "it drove on");
    }
}
