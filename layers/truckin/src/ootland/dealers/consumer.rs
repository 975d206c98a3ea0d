//! A consumer: wants items at a fixed rate, never buys more than it wants, one price for all.

use super::super::dealer_manager::Manager;

/// A dealer who buys ITEMS.
#[derive(Clone, Debug)]
pub struct Consumer {
    /// Items wanted in 100 slots.
    pub items_per_100_slots: i32,
    /// Hundredths of an item wanted.
    pub begun: i32,
}

impl Consumer {
    /// Wants what is due in one slot. What it cannot get it goes on wanting, up to its storage.
    pub fn play(&mut self, manager: &mut Manager) {
        self.begun += self.items_per_100_slots;
        if self.begun >= 100 {
            let wanted = self.begun / 100;
            self.begun %= 100;
            manager.want_items(wanted);
        }
    }
}
