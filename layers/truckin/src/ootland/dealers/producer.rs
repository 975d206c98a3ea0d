//! A producer: makes crates at a fixed rate until its yard is full, one price for all producers.

use super::super::dealer_manager::Manager;
use super::super::ledger::Ledger;

/// A dealer who makes and sells CRATES.
#[derive(Clone, Debug)]
pub struct Producer {
    /// Crates made in 100 slots.
    pub crates_per_100_slots: i32,
    /// Hundredths of a crate begun.
    pub begun: i32,
}

impl Producer {
    /// Makes what is due in one slot.
    pub fn play(&mut self, manager: &mut Manager, ledger: &mut Ledger) {
        self.begun += self.crates_per_100_slots;
        if self.begun >= 100 {
            let made = self.begun / 100;
            self.begun %= 100;
            ledger.crates_made += i64::from(manager.take_in_crates(made));
        }
    }
}
