//! The string of four digits that names a truck.

use std::fmt;
use std::str::FromStr;

use super::registry::{SLOTS, kinds};

/// One digit for each slot, lowest layer first: `0312` has gas getting 0, capital maintenance 3,
/// trading 1 and information gathering 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Chromosome([u8; 4]);

/// A string that names no truck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChromosomeFault {
    /// The string.
    pub text: String,
    /// Place of the wrong character, counted from 1; nothing when the length is wrong.
    pub place: Option<usize>,
    /// What was expected there.
    pub expected: String,
}

impl fmt::Display for ChromosomeFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "chromosome \"{}\"", self.text)?;
        if let Some(place) = self.place {
            write!(out, ", digit {place}")?;
        }
        write!(out, ": expected {}", self.expected)
    }
}

impl std::error::Error for ChromosomeFault {}

impl Chromosome {
    /// A chromosome of these genes; nothing when a slot has no such allele.
    pub fn new(genes: [u8; 4]) -> Option<Self> {
        genes
            .iter()
            .zip(kinds())
            .all(|(gene, kind)| *gene < kind)
            .then_some(Self(genes))
    }

    /// The genes, lowest layer first.
    pub fn genes(&self) -> [u8; 4] {
        self.0
    }
}

impl fmt::Display for Chromosome {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|gene| write!(out, "{gene}"))
    }
}

impl FromStr for Chromosome {
    type Err = ChromosomeFault;

    fn from_str(text: &str) -> Result<Self, ChromosomeFault> {
        let fault = |place, expected| ChromosomeFault {
            text: text.to_owned(),
            place,
            expected,
        };
        if text.chars().count() != SLOTS.len() {
            let expected = format!("{} digits, found {}", SLOTS.len(), text.chars().count());
            return Err(fault(None, expected));
        }
        let mut genes = [0; 4];
        for (index, (digit, slot)) in text.chars().zip(SLOTS).enumerate() {
            let gene = digit
                .to_digit(10)
                .filter(|gene| (*gene as usize) < slot.alleles.len());
            let Some(gene) = gene else {
                let expected = format!(
                    "0 to {} for {}, found '{digit}'",
                    slot.alleles.len() - 1,
                    slot.name
                );
                return Err(fault(Some(index + 1), expected));
            };
            genes[index] = gene as u8;
        }
        Ok(Self(genes))
    }
}
