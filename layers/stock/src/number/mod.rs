//! Arithmetic: numbers and vectors added, multiplied, bounded.
pub mod clamp;
pub mod difference;
pub mod gain;
pub mod max;
pub mod min;
pub mod offset;
pub mod product;
pub mod quotient;
pub mod sum;
