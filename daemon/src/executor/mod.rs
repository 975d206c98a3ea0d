//! Executor.

pub mod gauge;
