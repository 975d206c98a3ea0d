//! Evolution of creatures whose layers are slots with alternatives (Gantchev 2001, 4.1).
//!
//! Nothing in here knows trucks: a genome is a row of digits, an [`Arena`] says how many alternatives
//! each slot has and what a genome is worth.

pub mod arena;
pub mod crossover;
pub mod generation;
pub mod genome;

pub use arena::Arena;
pub use crossover::crossover;
pub use generation::{Breeding, Evolution, Generation};
pub use genome::{GENES_MAX, Genome};
