//! Wiring: from a creature file or a layer's manifest to a creature that is known to be sound.
//!
//! ```text
//!  file ──► syntax (TOML with places) ──► read (parts) ──► check (names, types, levels) ──► Creature
//!                         └─────────────── findings: every error at once ───────┘
//! ```
//!
//! Must never run anything: the catalogue says what a module looks like, not what it does.

pub mod catalog;
pub mod check;
pub mod creature;
pub mod diagnostic;
pub mod directory;
pub mod document;
pub mod grammar;
pub mod policy;
mod read;
mod render;
pub mod rule;
pub mod schema;
pub mod sketch;
mod syntax;

pub use catalog::{Attached, Catalog, Declaration, Fault, Parameter, Port, Setting, Takes};
pub use creature::{BODY, Creature, PortName};
pub use diagnostic::{Files, Rejected, Source};
pub use directory::Directory;
pub use render::{Paint, Piece};
pub use rule::Rule;
