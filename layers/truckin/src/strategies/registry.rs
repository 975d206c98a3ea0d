//! Which alleles there are for which slot.

use backplane::BehaviourLayer;

use super::chromosome::Chromosome;
use super::{capital, gas, information, trading};
use crate::ootland::chance::Chance;
use crate::ootland::grid::Grid;
use crate::ootland::{TruckCreature, truck::TruckLayer};

/// A layer that can be plugged into a slot.
pub trait MicroStrategy: BehaviourLayer<TruckCreature> + Send + Sized + 'static {
    /// A fresh one for a game in a country of this size, with chance of its own.
    fn new(grid: Grid, chance: Chance) -> Self;
}

/// One micro-strategy as the registry knows it.
#[derive(Clone, Copy, Debug)]
pub struct Allele {
    /// Its name, which is its file's.
    pub name: &'static str,
    /// The text of its file; the first line is its idea.
    pub source: &'static str,
    /// Makes one.
    pub build: fn(Grid, Chance) -> TruckLayer,
}

impl Allele {
    /// The idea, in the words of the first line of its file.
    pub fn idea(&self) -> &'static str {
        self.source
            .lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches("//!")
            .trim()
    }
}

/// A slot and its alternatives.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    /// The layer's subgoal.
    pub name: &'static str,
    /// The alternatives; the index is the digit in the chromosome.
    pub alleles: &'static [Allele],
}

/// The slots of a truck, lowest layer first.
pub const SLOTS: [Slot; 4] = [
    Slot {
        name: "gas getting",
        alleles: gas::ALLELES,
    },
    Slot {
        name: "capital maintenance",
        alleles: capital::ALLELES,
    },
    Slot {
        name: "trading",
        alleles: trading::ALLELES,
    },
    Slot {
        name: "information gathering",
        alleles: information::ALLELES,
    },
];

/// Lists the files of one slot, in the order of their digits: declares each and registers the type.
macro_rules! micro_strategies {
    ($($file:ident :: $strategy:ident),+ $(,)?) => {
        $(mod $file;)+
        $(pub use $file::$strategy;)+
        /// The alternatives of this slot, in the order of their digits.
        pub const ALLELES: &[$crate::strategies::Allele] = &[$(
            $crate::strategies::Allele {
                name: stringify!($file),
                source: include_str!(concat!(stringify!($file), ".rs")),
                build: |grid, chance| Box::new(
                    <$strategy as $crate::strategies::MicroStrategy>::new(grid, chance)
                ),
            }
        ),+];
    };
}
pub(crate) use micro_strategies;

/// How many alternatives each slot has.
pub fn kinds() -> [u8; 4] {
    SLOTS.map(|slot| slot.alleles.len() as u8)
}

/// The layers a chromosome names, lowest first.
///
/// # Panics
/// When the chromosome names an allele that is not there; one that was parsed cannot.
pub fn build(chromosome: &Chromosome, grid: Grid, chance: &mut Chance) -> Vec<TruckLayer> {
    let slots = SLOTS.iter().zip(chromosome.genes()).enumerate();
    slots
        .map(|(layer, (slot, gene))| (slot.alleles[usize::from(gene)].build)(grid, chance.fork(layer as u64)))
        .collect()
}

/// Every truck there is, in the order of their numbers.
pub fn all_chromosomes() -> Vec<Chromosome> {
    let kinds = kinds();
    let count: u32 = kinds.iter().map(|kind| u32::from(*kind)).product();
    (0..count)
        .map(|mut number| {
            let mut genes = [0; 4];
            for (gene, kind) in genes.iter_mut().zip(kinds).rev() {
                *gene = (number % u32::from(kind)) as u8;
                number /= u32::from(kind);
            }
            Chromosome::new(genes).expect("a number below the product of the kinds")
        })
        .collect()
}
