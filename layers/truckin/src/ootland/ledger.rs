//! The books of the country: what came in from outside and what left it.
//!
//! Money moves between trucks, retailers and gas stations. It enters where consumers pay and leaves
//! where producers and the telephone are paid; all three are booked here. Crates enter where they are
//! produced and turn into items where a retailer unpacks them; items leave where they are consumed;
//! gas leaves where it is burnt. [`Ledger::check`] adds everything up again.

use std::fmt;

use super::rules::ITEMS_PER_CRATE;

/// Running totals since the start of the game.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ledger {
    /// Paid to producers.
    pub producers_took_cents: i64,
    /// Paid by consumers.
    pub consumers_paid_cents: i64,
    /// Paid for calls.
    pub telephone_took_cents: i64,
    /// Crates produced.
    pub crates_made: i64,
    /// Crates unpacked by retailers.
    pub crates_unpacked: i64,
    /// Items consumed or waiting to be at a consumer's: out of the country either way.
    pub items_consumed: i64,
    /// Gas sold by gas stations.
    pub gas_sold_millilitres: i64,
    /// Gas burnt by trucks.
    pub gas_burnt_millilitres: i64,
}

/// Everything the parties hold at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holdings {
    /// Capital of trucks, retailers and gas stations.
    pub cents: i64,
    /// Crates with producers, retailers and trucks.
    pub crates: i64,
    /// Items with retailers and trucks.
    pub items: i64,
    /// Gas in tanks.
    pub gas_millilitres: i64,
    /// The smallest single capital, stock or tank among them.
    pub least: i64,
}

/// The books do not add up, or somebody holds less than nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LedgerFault {
    /// What does not add up.
    pub what: &'static str,
    /// How much there should be.
    pub expected: i64,
    /// How much there is.
    pub found: i64,
}

impl fmt::Display for LedgerFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "{}: {} in the books, {} in the country",
            self.what, self.expected, self.found
        )
    }
}

impl Ledger {
    /// Compares what the parties hold with what they held at the start and what was booked since.
    ///
    /// # Errors
    /// The first sum that does not come out to the cent, item and millilitre.
    pub fn check(&self, start: &Holdings, now: &Holdings) -> Result<(), LedgerFault> {
        let expected_cents =
            start.cents + self.consumers_paid_cents - self.producers_took_cents - self.telephone_took_cents;
        let expected_items =
            start.items + self.crates_unpacked * i64::from(ITEMS_PER_CRATE) - self.items_consumed;
        let sums = [
            ("cents", expected_cents, now.cents),
            (
                "crates",
                start.crates + self.crates_made - self.crates_unpacked,
                now.crates,
            ),
            ("items", expected_items, now.items),
            (
                "millilitres of gas",
                start.gas_millilitres + self.gas_sold_millilitres - self.gas_burnt_millilitres,
                now.gas_millilitres,
            ),
            ("the least anybody holds", now.least.max(0), now.least),
        ];
        match sums.into_iter().find(|(_, expected, found)| expected != found) {
            Some((what, expected, found)) => Err(LedgerFault {
                what,
                expected,
                found,
            }),
            None => Ok(()),
        }
    }
}
