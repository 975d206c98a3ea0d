//! Pictures of creatures in the manner of Brooks 1991, figure 2.
//!
//! ```text
//!  creature, sketch, joined layers ──► model ──► rank ──► order ──► place ──► route ──► lengths ──► drawing ──► SVG
//!                                        └──► Graphviz text
//! ```
//!
//! Layers are stacked with level 0 at the bottom, sensors stand at the left and actuators at the right, wires
//! run in channels between the boxes. Must never run, check or change a creature, and never draw the same
//! creature in two ways.

mod compact;
mod dot;
mod drawing;
mod gather;
mod heights;
mod lay;
mod maze;
mod measure;
mod model;
mod order;
mod pieces;
mod place;
mod rank;
mod route;
mod solve;
mod svg;
mod widths;
pub mod xml;

pub use dot::dot;
pub use drawing::{At, Circle, Drawing, Frame, Line, RADIUS, Shape, Strip, Wire};
pub use gather::{of_creature, of_sketches};
pub use lay::draw;
pub use model::{Band, ENDS_MAX, End, Model, Net, Node, Port, Role, Tap};
pub use svg::{Dress, svg};
