//! Level 4, company: follows whoever walks before the robot, for a while.
//!
//! ```text
//!  map, pose ─► follow ─heading─►(S) into avoid of level 1, above corridor's
//! ```
pub mod follow;
