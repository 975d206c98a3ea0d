//! ADROIT: releasing mechanisms, and the language that assembles them (Friedman 1969).
//!
//! - [`hierarchy`]: the elements and the one recursive evaluation
//! - [`language`]: the text that assembles them, and commands to a running hierarchy

pub mod hierarchy;
pub mod language;
pub mod learning;
pub mod nest;
pub mod planning;
