//! Hierarchies of releasing mechanisms as modules of layers (Friedman 1969 on Brooks 1991).
//!
//! A module here is a hierarchy from the `adroit` crate between registers and outputs: [`drives`] is level 2 on
//! Allen's levels 0 and 1, [`nest`] builds nests. A hierarchy beats on a real-time thread; [`desk`] is where commands to it come in.
//!
//! Must never decide anything itself: that stands in programs of the assembly language.

pub mod desk;
mod drawing;
pub mod drives;
mod lamps;
pub mod nest;
mod programs;

pub use drawing::{Drawing, drawing};

use afsm::{Kinds, ModuleKind};
use ipc::wiring::Source;

/// Every kind of module of this crate.
pub const MODULES: &[&ModuleKind] = &[&drives::KIND, &nest::KIND];

/// Level 2 on Allen as the manifest of a layer process.
pub const DRIVES: &str = include_str!("../drives.toml");

/// The nest builder: its body, and its hierarchy in a layer.
pub const NEST: &str = include_str!("../nest.toml");

/// The kinds that a layer process of this crate is built with.
pub fn kinds() -> Kinds {
    Kinds::default().with(MODULES.iter().copied())
}

/// The manifest of level 2 on Allen.
pub fn drives_manifest() -> Source {
    Source::new("drives.toml", DRIVES)
}
