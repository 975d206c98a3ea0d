//! Figures over many seeded worlds: how well the robot builds, with and without planning, and how it learns.

mod chance;
mod nests;

pub use chance::{Chance, chance};
pub use nests::{Bound, Figures, LIMIT_S, Summary, bound, nests};
