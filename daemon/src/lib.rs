//! The keeper of a creature's body: executor, halt gate, motor unit, bodies, and what the `subsumed` daemon is
//! made of.
//!
//! Must never know a behaviour; layers come to it as checked wiring and boxes that step.

pub mod alloc;
pub mod body;
pub mod control;
pub mod events;
pub mod executor;
pub mod gate;
pub mod machine;
pub mod metrics;
pub mod motor;
pub mod options;
pub mod plugs;
pub mod recorder;
pub mod replay;
pub mod running;
pub mod status;
pub mod view;
pub mod virtual_run;
