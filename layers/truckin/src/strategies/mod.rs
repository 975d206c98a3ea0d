//! The four slots of a truck and the micro-strategies that fit them (Gantchev 2001, 4.1).
//!
//! A chromosome names one allele for each slot, lowest layer first. Micro-strategies know the
//! backplane and their controller; they never know each other.

pub mod capital;
pub mod chromosome;
pub mod counter;
pub mod gas;
pub mod information;
pub mod notebook;
pub mod registry;
pub mod roads;
pub mod trading;

pub use chromosome::{Chromosome, ChromosomeFault};
pub use registry::{Allele, MicroStrategy, SLOTS, Slot, all_chromosomes, build, kinds};
