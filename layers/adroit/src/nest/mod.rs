//! The nest-building robot of the source, its world, and its primitives.
//!
//! Must never: decide what to do next; that is written in `programs/nest.adroit`.
//!
//! ```text
//!   world ──eyes──► robot's memory ──primitives──► hierarchy ──outputs──► motor control units ──► world
//! ```
//!
//! All of it runs on the virtual clock in beats of [`BEAT_S`]; a run is repeatable to the bit from its seed.

mod belief;
mod course;
mod eyes;
mod generator;
mod geometry;
mod intervention;
mod motor;
mod person;
mod picture;
mod pilot;
mod primitives;
mod robot;
mod run;
mod scenes;
mod sweep;
mod wired;
mod world;

pub use generator::{Layout, WORLD_STATIONS, generate};
pub use geometry::Point;
pub(crate) use geometry::{between_rad, distance_to_segment_m};
pub use motor::Unit;
pub use person::Person;
pub use picture::{Lamp, Picture, View, picture, view};
pub use pilot::Pilot;
pub use primitives::{STIMULI, vocabulary};
pub use robot::{
    ARM_M, CLEARANCE_M, EYES_RANGE_M, EYES_SIDE_RAD, METRES_ON_A_TANK, RADIUS_M, Robot, SPEED_M_S,
};
pub use run::{Measures, Run};
pub use scenes::Scene;
pub use wired::{OBSTACLES_TOLD_MAX, Sensed, Setpoints, TOLD_MAX, Told};
pub use world::{BEAT_S, Disc, FLOOR_X_M, FLOOR_Y_M, NEST_RADIUS_M, Object, Site, Station, World};

/// The nest-building program, with refuelling in the arrangement of two thresholds.
pub const PROGRAM: &str = include_str!("../../programs/nest.adroit");

/// Commands that turn the program's refuelling into the arrangement of a single threshold.
pub const ONE_THRESHOLD: &str = include_str!("../../programs/one-threshold.adroit");
