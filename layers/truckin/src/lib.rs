//! Truckin': trucks in four layers that trade in OOTland, and the evolution of their layers.
//!
//! The system of Gantchev 2001, chapters 2 and 4, on the arbitration of the `backplane` crate.

pub mod arena;
pub mod command;
pub mod evolve;
pub mod grid;
pub mod ootland;
pub mod report;
pub mod strategies;
pub mod wired;
