//! Level 5, home: goes back to where it started, the way it came, when the battery runs low, and stays until
//! it is full.
//!
//! ```text
//!  battery ─► hunger ─hungry─► trail ─heading─►(S) into avoid of level 1, above all others
//!                   pose ──────►  │  └─calm──►(I) whenlook of level 2: no new places
//!                                 └────stay──►(I) avoid of level 1: level 0 alone keeps the place
//! ```
pub mod hunger;
pub mod trail;
