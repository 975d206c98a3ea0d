//! A retailer: buys crates, unpacks them, sells items, and moves its two prices with its stock.

use super::super::dealer_manager::Manager;
use super::super::ledger::Ledger;
use super::super::rules::ITEMS_PER_CRATE;

/// Slots between two looks at the prices: two hours.
const PRICE_SLOTS: u32 = 12;
/// How far its price for crates goes from the one it opened with, in hundredths: lowest, highest.
/// Without such a band one thoughtless truck, or a time without any, would send prices to where nobody
/// trades again.
const BUYING_BAND: (i64, i64) = (85, 125);
/// The same for its price for items.
const SELLING_BAND: (i64, i64) = (85, 115);

/// A dealer who buys CRATES and sells ITEMS.
#[derive(Clone, Debug)]
pub struct Retailer {
    /// Slots until it looks at its prices again.
    pub until_prices: u32,
    /// Least margin on a crate bought, unpacked and sold, in cents.
    pub margin_cents: i32,
    /// The prices it opened with, for crates and for items, in cents.
    pub opening_cents: (i32, i32),
    /// Crates it had bought, all in all, when it last looked.
    pub bought_then: i64,
    /// Items it had sold, all in all, when it last looked.
    pub sold_then: i64,
}

impl Retailer {
    /// Unpacks a crate when there is room for what is in it, and now and then moves its prices.
    pub fn play(&mut self, manager: &mut Manager, ledger: &mut Ledger) {
        ledger.crates_unpacked += i64::from(manager.unpack());
        if self.until_prices == 0 {
            self.until_prices = PRICE_SLOTS;
            self.move_prices(manager);
        }
        self.until_prices -= 1;
    }

    /// A hundredth at a time: a price that finds no takers comes towards them, one that finds too many
    /// goes away from them, both within their bands. Crates are never paid more for than their items bring less the margin.
    fn move_prices(&mut self, manager: &mut Manager) {
        let bought = manager.bought_units() > self.bought_then;
        let sold = manager.sold_units() > self.sold_then;
        (self.bought_then, self.sold_then) = (manager.bought_units(), manager.sold_units());
        let crates_plenty = manager.crates() * 2 > manager.crate_storage();
        let items_scarce = manager.items() * 4 < manager.item_storage();
        let cent = |price: i32| (price / 100).max(1);
        let mut selling = manager.selling_cents();
        if sold && items_scarce {
            selling += cent(selling);
        } else if !sold && manager.items() > 0 {
            selling -= cent(selling);
        }
        selling = within(selling, self.opening_cents.1, SELLING_BAND);
        let mut buying = manager.buying_cents();
        if bought && crates_plenty {
            buying -= cent(buying);
        } else if !bought && !crates_plenty {
            buying += cent(buying);
        }
        buying = within(buying, self.opening_cents.0, BUYING_BAND)
            .min(selling * ITEMS_PER_CRATE - self.margin_cents);
        manager.set_prices(buying, selling);
    }
}

fn within(price: i32, opening: i32, (lowest, highest): (i64, i64)) -> i32 {
    let opening = i64::from(opening);
    i64::from(price).clamp(opening * lowest / 100, opening * highest / 100) as i32
}
