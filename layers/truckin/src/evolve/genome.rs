//! A row of genes, one for each slot.

use std::fmt;

use arrayvec::ArrayVec;

use crate::ootland::Chance;

/// Slots of a creature at most; twice what the backplane's layers need.
pub const GENES_MAX: usize = 16;

/// Which alternative is in which slot.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Genome(pub ArrayVec<u8, GENES_MAX>);

impl Genome {
    /// A genome of these genes.
    ///
    /// # Panics
    /// When there are more than [`GENES_MAX`].
    pub fn new(genes: &[u8]) -> Self {
        Self(genes.iter().copied().collect())
    }

    /// One drawn at random; `kinds` is the number of alternatives of each slot.
    pub fn random(kinds: &[u8], chance: &mut Chance) -> Self {
        Self(
            kinds
                .iter()
                .map(|kind| chance.below(u32::from(*kind)) as u8)
                .collect(),
        )
    }

    /// The genes in the order of the slots.
    pub fn genes(&self) -> &[u8] {
        &self.0
    }
}

impl fmt::Display for Genome {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|gene| write!(out, "{gene}"))
    }
}
