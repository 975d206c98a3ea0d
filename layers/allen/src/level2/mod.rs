//! Level 2, explore: looks for distant places and tries to reach them (Brooks 1991 §6.2, third layer, and
//! figure 2).
//!
//! ```text
//!  speed, rate ─► whenlook ─look─► stereo ─path─► pathplan ─heading─►(S) into avoid of level 1
//!                   │  ▲             ▲ fan          │  ▲  └ start ┐
//!                   │  └── pursuing ──── from pathplan  │         ▼
//!                   └─hold─►(I) wander of level 1       └─ travelled ─ integrate ◄─ odometry
//! ```
pub mod integrate;
pub mod pathplan;
pub mod stereo;
pub mod whenlook;
