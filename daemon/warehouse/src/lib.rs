//! A warehouse on a grid, with a robot and people in it: a world of another making than the office.
//!
//! ```text
//!  seed ─► floor (cells) ─► world: wheels with a lag ─► discs against cells and discs ─► ranges, contacts
//! ```
//! Repeatable to the bit from its seed; it knows no layer, no wire and no clock.

#![forbid(unsafe_code)]

mod floor;
mod world;

pub use floor::Floor;
pub use world::{Caused, PERSON_RADIUS_M, ROBOT_RADIUS_M, Report, SONARS, Warehouse};
