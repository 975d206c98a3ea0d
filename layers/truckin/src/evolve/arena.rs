//! Where a population is put to the test.

use super::genome::Genome;

/// The creature's side of evolution.
pub trait Arena {
    /// How many alternatives each slot has.
    fn kinds(&self) -> &[u8];

    /// What each member of a population is worth in this generation, in the order of the members.
    /// More is better; the same arguments give the same answer.
    fn fitness(&self, generation: u32, population: &[Genome]) -> Vec<i64>;
}
