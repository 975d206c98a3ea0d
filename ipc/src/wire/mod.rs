//! Wires: the memory behind them, their two ends, and the registers and outlets that modules see.
//!
//! Must never know what a message means or which module reads it.
//!
//! *Cell*: the one-message memory of a wire. *Page*: the cells of all wires one process writes.
//! *Register*: the one-element buffer behind an input port. *Outlet*: the writing end behind an output port.

pub mod cell;
pub mod gauge;
pub mod iceoryx;
pub mod joined;
pub mod limits;
pub mod outlet;
pub mod page;
pub mod register;
mod room;
mod series;
mod sync;

pub use cell::{LAYOUT, Reading};
pub use gauge::{TapCounts, TapGauge};
pub use joined::{AHEAD_MAX, Fate, Plug, Room, TAPS_MAX, TapEnd, TapLook, TapState};
pub use limits::Limits;
pub use outlet::{Outlet, OutputCounts};
pub use page::{Page, Reader, WIRES_MAX, Writer};
pub use register::{InputCounts, Register, Took};
