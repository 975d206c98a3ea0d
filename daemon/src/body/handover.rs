//! Handing things to a thread that must not wait: what it held before comes back, to be dropped elsewhere.
//!
//! Must never drop, allocate or wait at the taking end.

use rtrb::{Consumer, Producer, RingBuffer};

/// Things under way at once, each way: one is handed over at a time, and its giver sweeps first.
const UNDER_WAY_MAX: usize = 4;

/// The end that hands over, on an ordinary thread.
#[derive(Debug)]
pub struct Giver<T> {
    new: Producer<T>,
    old: Consumer<T>,
}

/// The end that takes, on a thread that must not wait.
#[derive(Debug)]
pub struct Taker<T> {
    new: Consumer<T>,
    old: Producer<T>,
}

/// Both ends.
pub fn handover<T>() -> (Giver<T>, Taker<T>) {
    let (new_in, new_out) = RingBuffer::new(UNDER_WAY_MAX);
    let (old_in, old_out) = RingBuffer::new(UNDER_WAY_MAX);
    (
        Giver {
            new: new_in,
            old: old_out,
        },
        Taker {
            new: new_out,
            old: old_in,
        },
    )
}

impl<T> Giver<T> {
    /// Hands `thing` over, to be taken at the next beat; `Err` gives it back when the other end does not beat.
    pub fn give(&mut self, thing: T) -> Result<(), T> {
        self.sweep();
        self.new.push(thing).map_err(|rtrb::PushError::Full(thing)| thing)
    }

    /// Drops what came back.
    pub fn sweep(&mut self) {
        while self.old.pop().is_ok() {}
    }
}

impl<T> Taker<T> {
    /// Takes what was handed over in the place of what is held. Says whether there was something.
    pub fn take(&mut self, held: &mut T) -> bool {
        // Without room for the old one it would have to be dropped here; the giver sweeps soon.
        if self.old.is_full() {
            return false;
        }
        let Ok(new) = self.new.pop() else {
            return false;
        };
        let old = std::mem::replace(held, new);
        let _room = self.old.push(old);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn what_was_held_comes_back_to_the_giver_and_is_dropped_there() {
        let (mut giver, mut taker) = handover();
        let first = Arc::new(1);
        let mut held = first.clone();
        assert!(!taker.take(&mut held));
        giver.give(Arc::new(2)).expect("there is room");
        assert!(taker.take(&mut held));
        assert_eq!((*held, Arc::strong_count(&first)), (2, 2));
        giver.sweep();
        assert_eq!(Arc::strong_count(&first), 1);
    }

    #[test]
    fn a_taker_without_room_for_the_old_waits_and_a_giver_without_a_taker_is_told() {
        let (mut giver, mut taker) = handover();
        let mut held = 0;
        for n in 1..=UNDER_WAY_MAX {
            giver.new.push(n).expect("there is room");
            assert!(taker.take(&mut held));
        }
        giver.new.push(99).expect("there is room");
        assert!(!taker.take(&mut held), "nothing was swept yet");
        giver.sweep();
        assert!(taker.take(&mut held));
        for n in 0..UNDER_WAY_MAX {
            giver.give(n).expect("there is room");
        }
        assert_eq!(giver.give(7), Err(7));
    }
}
