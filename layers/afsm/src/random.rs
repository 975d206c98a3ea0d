//! Randomness for modules: seeded, so that a run repeats to the bit.

use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg32;

/// A stream of random numbers that its seed determines.
#[derive(Clone, Debug)]
pub struct Random(Pcg32);

impl Random {
    /// The stream of `seed`.
    pub fn new(seed: u64) -> Random {
        Random(Pcg32::seed_from_u64(seed))
    }

    /// A number from `low` up to, not including, `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u32() as f64 / 4_294_967_296.0)
    }
}
