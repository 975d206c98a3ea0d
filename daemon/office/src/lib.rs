//! A simulated office with people in it, and the round robot Allen with its ring of sonars.
//!
//! A world to measure a creature in, never a part of the creature: the office knows no layer, no
//! wire and no clock, and takes no decision for the robot. It is repeatable to the bit: equal
//! [`Config`]s and equal calls give equal results, in debug and release builds alike.
//!
//! ```text
//!   Drive ──► robot ──► discs ◄── people ◄── ways        config    layout ◄── layout_text
//!               │         │                                          │
//!               │       space (rapier) ◄── fittings ◄────────────────┴── generator ◄── seed
//!               ▼         │
//!           odometry      ├──► sonar ──► twelve ranges
//!                         ├──► camera ──► twelve free distances
//!                         └──► contacts
//! ```
//!
//! Local words: a *disc* is anything that moves; a *thing* is anything that does not; a *place* is
//! a way point of the people; a contact is *caused* when the robot drove into what it touched.
//!
//! ```
//! use office::{Config, Drive, Office};
//!
//! let mut office = Office::new(&Config::default());
//! office.step(0.02, Drive { forward: 0.3, turn: 0.0 });
//! assert!(office.sonar().iter().all(|range| *range <= 10.67));
//! ```

#![forbid(unsafe_code)]

mod camera;
mod config;
mod contacts;
mod discs;
mod fittings;
mod generator;
mod layout;
mod layout_form;
mod layout_text;
mod noise;
mod office;
mod people;
mod plane;
mod robot;
mod sonar;
mod space;
mod view;
mod ways;

pub use camera::{CameraModel, STRIPS};
pub use config::{
    BaseModel, Config, Drive, FittingsModel, OdometryModel, PEOPLE_MAX, PERSON_RADIUS_M, Pose,
    ROBOT_RADIUS_M, ROBOTS_MAX,
};
pub use contacts::{CAUSED_ABOVE_M_S, CONTACTS_KEPT_MAX, Contact, Contacts};
pub use generator::generate;
pub use layout::{
    BLOCKS_MAX, Block, Door, KEPT, Kind, LAYOUT_BYTES_MAX, Layout, PLACES_MAX, Place, Room, Surface,
    WALL_THICKNESS_M,
};
pub use layout_text::LayoutError;
pub use office::Office;
pub use sonar::{SONARS, SonarModel};
pub use view::{FloorPlan, PersonKind, PersonView, View};
