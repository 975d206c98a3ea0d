//! Creatures on trial: a creature, its body and its office on the virtual clock, watched from outside.
//!
//! Must never help the creature: a [`Trial`] lets time pass and looks; what it may do to the world, put a
//! person into it, is what the world does anyway.
//!
//! *Headings* are the directions that the robot drove off in; *rooms* are those of the standard office.

pub mod allens;
pub mod trial;

pub use allens::Allen;
pub use trial::{Figures, Trial};
