//! Bits: gates, votes, and what turns on and off.
pub mod and;
pub mod edge;
pub mod flipflop;
pub mod majority;
pub mod not;
pub mod or;
pub mod toggle;
pub mod xor;
