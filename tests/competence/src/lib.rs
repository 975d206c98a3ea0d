//! How well Allen does: rows of creatures and disturbances, measured over many seeds on the virtual clock.
//!
//! ```text
//!  row ─► creature text ─► trial (one seed, one simulated hour) ─► figures ─┐
//!                                                         many seeds ─► summary with confidence intervals
//!                                                                  ├─► table: text, Markdown, JSON
//!                                                                  ├─► plot: SVG
//!                                                                  └─► what was to be reached
//! ```
//! Must never help the creature, nor measure it in a layout that it was built in: those are numbered 1 to 10,
//! trials draw theirs from 1001 on.

pub mod disturb;
pub mod figures;
pub mod goals;
pub mod measure;
pub mod plot;
pub mod row;
pub mod statistics;
pub mod story;
pub mod table;
pub mod trial;

pub use figures::Figures;
pub use measure::{Measured, Order, measure};
pub use row::{ROWS, Row};
