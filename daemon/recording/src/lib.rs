//! Recordings: everything that happened on a creature's wires, in MCAP files that describe themselves.
//!
//! - [`manifest`]: what a recording says of the creature before anything happens
//! - [`item`]: what happens, as it passes from the daemon's threads to a recording
//! - [`ring`]: the last minute of it, bounded, for when something goes wrong
//! - [`writer`], [`schema`]: items into MCAP, as JSON with JSON Schemas
//! - [`reader`]: MCAP back into messages and beats
//! - [`ros2`]: a recording as ROS 2 tools want it
//! - [`why`]: the chain behind a message
//!
//! Must never run on a real-time thread, and never lose anything without counting it.
//!
//! Local words: a *source* is a thread that beats (a layer, or the motor unit); a *slot* is the place of one of its
//! registers or outlets, in the order of the creature file.

pub mod item;
pub mod manifest;
pub mod reader;
pub mod ring;
pub mod ros2;
pub mod schema;
mod text;
pub mod why;
pub mod writer;

pub use item::Item;
pub use manifest::{Manifest, Plugged};
pub use reader::{Recording, read};
pub use ring::Ring;
pub use writer::Writer;
