//! Game time: slots of ten minutes, and an end that is announced from the start.

use super::rules::SLOT_MINUTES;

/// What time it is in the game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    /// The slot being played, counted from 0.
    pub slot: u32,
    /// Slots in the game.
    pub slots: u32,
}

impl Clock {
    /// Minutes from the start of the game to the start of this slot.
    pub fn since_start_minutes(self) -> i32 {
        self.slot as i32 * SLOT_MINUTES
    }

    /// Minutes from the start of this slot to the end of the game.
    pub fn remaining_minutes(self) -> i32 {
        (self.slots - self.slot) as i32 * SLOT_MINUTES
    }
}
