//! The module kit: augmented finite state machines and the layers made of them.
//!
//! A module is one enum and one `match` ([`module`]), declared with its ports ([`kind`], [`port`]); a layer is
//! its modules stepped together once a beat ([`layer`]), built from a checked creature file ([`assemble`]),
//! inside the daemon or as a process of its own ([`process`]).
//!
//! Must never know a body or the daemon's insides.

pub mod assemble;
pub mod kind;
pub mod layer;
pub mod module;
pub mod places;
pub mod port;
pub mod process;
pub mod random;
mod seat;
pub mod trace;

pub use kind::{Kinds, ModuleKind, Settings};
pub use module::{Beat, Module};
pub use port::{In, Out};
