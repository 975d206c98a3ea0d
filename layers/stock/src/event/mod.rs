//! Events: pulses counted and timed.
pub mod counter;
pub mod monoflop;
pub mod timer;
