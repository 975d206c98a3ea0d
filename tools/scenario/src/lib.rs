//! Scenario files: a creature on the virtual clock, messages put on its wires, and what must come of it.
//!
//! ```text
//!  file ──► read (every name resolved, every error at once) ──► Scenario ──► run ──► judge ──► report
//! ```
//! - [`plan`]: a scenario as checked
//! - [`read`]: from the file to a plan
//! - [`kinds`]: the kinds of module that scenarios may use beside the daemon's
//! - [`run`]: a plan on the virtual clock, and what came of it
//! - [`judge`]: whether what came is what was expected
//! - [`suite`]: files and folders, run in parallel
//! - [`prefixes`]: every prefix of the stack works, whatever the layers above do
//! - [`report`]: for people, for programs, for continuous integration
//!
//! Must never tell the time: what a scenario says is the same whenever and wherever it runs.

mod around;
mod expectations;
pub mod judge;
pub mod kinds;
mod names;
pub mod plan;
pub mod prefixes;
pub mod read;
pub mod report;
pub mod run;
mod stimuli;
pub mod suite;
mod values;
