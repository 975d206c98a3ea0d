//! Level 3, corridor: keeps the robot going along a corridor that it happens to be in.
//!
//! ```text
//!  map, compass ─► corridor ─heading─►(S) into avoid of level 1, above pathplan's
//! ```
pub mod corridor;
