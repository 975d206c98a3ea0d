//! Level 1, wander: makes the robot wander about when it is not busy avoiding things (Brooks 1991 §6.2,
//! second layer).
//!
//! ```text
//!  wander ─heading─► avoid ─heading─►(S) into turn of level 0
//!                      ▲ force of level 0's feelforce
//! ```
pub mod avoid;
pub mod wander;
