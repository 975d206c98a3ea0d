//! Dealing over the counter: what could be bought and sold here, and what was refused.

use backplane::Feedback;

use crate::ootland::{Commodity, Controller, Corner, Kind, Outcome, TruckCreature};

/// Minutes before a dealer that came up short is asked again.
const ASK_AGAIN_MINUTES: i32 = 60;

/// Remembers that the dealer here sold or bought less than was asked, so as not to ask for ever.
#[derive(Clone, Debug, Default)]
pub struct Counter {
    here: Option<Corner>,
    sells_again_minute: i32,
    buys_again_minute: i32,
}

/// Something the dealer here would trade, as far as the truck can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deal {
    /// What.
    pub commodity: Commodity,
    /// Units the truck could buy for all its money, or has to sell.
    pub units: i32,
    /// Price of one, in cents.
    pub cents: i32,
}

impl Counter {
    /// Notes what the last plan's trades came to.
    pub fn learn(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        if self.here != Some(body.corner()) {
            *self = Self {
                here: Some(body.corner()),
                ..Self::default()
            };
        }
        let Some(selected) = heard.selected() else { return };
        let again = body.since_start_minutes() + ASK_AGAIN_MINUTES;
        for outcome in selected.outcomes {
            match *outcome {
                Outcome::Bought { asked, units, .. } if units < asked => self.sells_again_minute = again,
                Outcome::Sold { offered, units, .. } if units < offered => self.buys_again_minute = again,
                _ => {}
            }
        }
    }

    /// Goods the dealer here sells, and how many the truck could pay for while keeping `keep_cents`.
    pub fn on_sale(&self, body: &Controller<'_>, keep_cents: i64) -> Option<Deal> {
        let card = body.dealer_here();
        let commodity = card.kind.sells().filter(|_| card.kind != Kind::GasStation)?;
        let units = (body.capital_cents() - keep_cents) / i64::from(card.selling_cents.max(1));
        let units = units.clamp(0, i64::from(i32::MAX)) as i32;
        let open = units > 0 && body.since_start_minutes() >= self.sells_again_minute;
        open.then_some(Deal {
            commodity,
            units,
            cents: card.selling_cents,
        })
    }

    /// Goods on board that the dealer here buys.
    pub fn in_demand(&self, body: &Controller<'_>) -> Option<Deal> {
        let card = body.dealer_here();
        let commodity = card.kind.buys()?;
        let units = if commodity == Commodity::Crates {
            body.crates()
        } else {
            body.items()
        };
        let open = units > 0 && body.since_start_minutes() >= self.buys_again_minute;
        open.then_some(Deal {
            commodity,
            units,
            cents: card.buying_cents,
        })
    }
}
