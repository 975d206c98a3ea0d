//! Seeded chance: one PCG stream for each game and each party in it.
//!
//! Nothing else in this crate draws a random number, so a game repeats to the bit from its seed.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// A stream of random numbers with a name of its own.
#[derive(Clone, Debug)]
pub struct Chance(Pcg32);

impl Chance {
    /// The stream `stream` of `seed`. The stream also moves the starting point: neighbouring streams
    /// of a PCG that start from one state begin alike.
    pub fn new(seed: u64, stream: u64) -> Self {
        let apart = Pcg32::seed_from_u64(stream).next_u64();
        Self(Pcg32::new(seed.wrapping_add(apart), stream))
    }

    /// A new stream that depends on this one's state and on `party`.
    pub fn fork(&mut self, party: u64) -> Self {
        let seed = self.0.next_u64();
        Self::new(seed, party)
    }

    /// A whole number from 0 to `bound - 1`.
    ///
    /// # Panics
    /// When `bound` is 0.
    #[inline]
    pub fn below(&mut self, bound: u32) -> u32 {
        assert!(bound > 0, "nothing is below 0");
        ((u64::from(self.0.next_u32()) * u64::from(bound)) >> 32) as u32
    }

    /// A whole number from `low` to `high`, both included.
    ///
    /// # Panics
    /// When `high` is below `low`.
    pub fn between(&mut self, low: i32, high: i32) -> i32 {
        assert!(low <= high, "from {low} up to {high}");
        low + self.below((high - low) as u32 + 1) as i32
    }

    /// A seed for something else.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Puts a list into random order.
    #[inline]
    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.below(last as u32 + 1) as usize);
        }
    }
}
