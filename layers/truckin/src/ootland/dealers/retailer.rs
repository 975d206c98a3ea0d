//! A retailer: buys crates, unpacks them, sells items, and moves its two prices with its stock.

use super::super::dealer_manager::Manager;
use super::super::ledger::Ledger;
use super::super::rules::ITEMS_PER_CRATE;

/// Slots between two looks at the prices: two hours.
const PRICE_SLOTS: u32 = 12;

/// A dealer who buys CRATES and sells ITEMS.
#[derive(Clone, Debug)]
pub struct Retailer {
    /// Slots until it looks at its prices again.
    pub until_prices: u32,
    /// Least margin on a crate bought, unpacked and sold, in cents.
    pub margin_cents: i32,
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

    /// Dear when scarce, cheap when plenty: a hundredth at a time, never without its margin.
    fn move_prices(&self, manager: &mut Manager) {
        let crates_full = manager.crates() * 4 / manager.crate_storage().max(1);
        let items_full = manager.items() * 4 / manager.item_storage().max(1);
        let cent = |price: i32| (price / 100).max(1);
        let mut buying = manager.buying_cents();
        let mut selling = manager.selling_cents();
        match items_full {
            0 => selling += cent(selling),
            1 | 2 => {}
            _ => selling -= cent(selling),
        }
        match crates_full {
            0 => buying += cent(buying),
            1 => {}
            _ => buying -= cent(buying),
        }
        buying = buying.min(selling * ITEMS_PER_CRATE - self.margin_cents);
        manager.set_prices(buying, selling);
    }
}
