//! The side-tap rules, checked message by message against a model of their own.
//!
//! Must never share a line of reasoning with the sources.
//!
//! - [`model`]: what the rules say, from every message there ever was
//! - [`rig`]: registers and outlets on pages in memory, and the histories they are run through
//! - [`series`]: suppressors in series before one input
//! - [`across`]: suppressors and inhibitors on one wire, and taps on taps
//! - [`changes`]: taps that come, go, or are heard late
//! - [`random`]: longer histories

mod across;
mod changes;
mod model;
mod random;
mod rig;
mod series;
