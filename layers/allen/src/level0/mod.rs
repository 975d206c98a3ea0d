//! Level 0, avoid: keeps the robot from hitting things, those that move and those that attack it included
//! (Brooks 1991 §6.2, first layer).
//!
//! ```text
//!            ┌─► collide ──────────── halt ──────────┐
//!  sonar ─map┤                                        ▼
//!            └─► feelforce ─force─► runaway ─heading─► turn ─go─► forward
//! ```
pub mod collide;
pub mod feelforce;
pub mod forward;
pub mod runaway;
pub mod sonar;
pub mod turn;
