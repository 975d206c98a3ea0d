//! Reports: one HTML file with its plots inside, which opens without a network.
//!
//! The only place with floats: means, spreads and pixels of what was counted in whole cents.

pub mod evolution;
pub mod experiment;
pub mod page;
pub mod statistics;
pub mod svg;

pub use page::Page;
