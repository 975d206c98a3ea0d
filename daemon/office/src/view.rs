//! What an observer may see of the office: copies for a page, never a way to change anything.
//!
//! Views allocate; a real-time thread has no business here.

use crate::config::Pose;
use crate::layout::{Block, Place};
use crate::sonar::SONARS;
use serde::Serialize;

/// Walls and furniture as they stand now: doors and chairs move, the rest never does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FloorPlan {
    /// The layout's name.
    pub name: String,
    /// Inside, west to east, m.
    pub width: f64,
    /// Inside, south to north, m.
    pub height: f64,
    /// Radius of the robot, m.
    pub robot_radius: f64,
    /// Radius of a person, m.
    pub person_radius: f64,
    /// Walls and furniture; open doors are not among them.
    pub blocks: Vec<Block>,
    /// Way points of the people.
    pub places: Vec<Place>,
}

/// What a person is in the office for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PersonKind {
    /// Walks about on business of their own.
    Walker,
    /// Walks at the robot and stands in its way.
    Attacker,
    /// Puts themselves where the robot has a wall behind it.
    Cornerer,
    /// Stands about with two others and talks.
    Talker,
    /// Walks on a straight line, placed by a test.
    Scripted,
}

/// One person.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PersonView {
    /// What they are here for.
    pub kind: PersonKind,
    /// m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// rad counter-clockwise from the x axis.
    pub heading: f64,
}

/// The office at one moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct View {
    /// s since the start.
    pub time_s: f64,
    /// Where the robot is.
    pub robot: Pose,
    /// Where the robot's odometry and compass believe it is.
    pub odometry: Pose,
    /// The latest sonar readings, m from the rim; all zero before the first.
    pub sonar: [f64; SONARS],
    /// The other robots.
    pub robots: Vec<Pose>,
    /// Everybody in the office.
    pub people: Vec<PersonView>,
    /// Contacts of the robot with anything so far.
    pub contacts: u64,
    /// Those that it caused.
    pub contacts_caused: u64,
}
