//! The keeper of a creature's body: executor, halt gate, motor unit, bodies, and what the `subsumed` daemon is
//! made of.
//!
//! Must never know a behaviour; layers come to it as checked wiring and boxes that step.

pub mod admission;
pub mod alloc;
pub mod body;
pub mod callers;
pub mod control;
mod door;
pub mod events;
pub mod executor;
pub mod feeder;
mod flow;
pub mod gate;
pub mod halt;
mod journal;
pub mod machine;
pub mod metrics;
pub mod motor;
mod newest;
pub mod options;
pub mod panicked;
pub mod plugs;
pub mod policy;
pub mod recorder;
pub mod reload;
pub mod replay;
pub mod running;
pub mod segment;
pub mod status;
pub mod threads;
pub mod timeline;
pub mod view;
pub mod virtual_run;
pub mod watchdog;
mod watcher;

/// What a name given on the command line must be.
pub const NAME_EXPECTED: &str = "expected 1 to 48 letters, digits, '-' or '_'";

/// Whether `name` can name an instance or a body: it becomes part of file and service names.
pub fn is_name(name: &str) -> bool {
    let sound = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    (1..=48).contains(&name.len()) && name.chars().all(sound)
}
