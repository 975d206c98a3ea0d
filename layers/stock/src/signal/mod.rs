//! Signals: numbers as they go on in time, and what is made of them.
pub mod compare;
pub mod differentiator;
pub mod integrator;
pub mod low_pass;
pub mod random;
pub mod rate_limit;
pub mod threshold;
