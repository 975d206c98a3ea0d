//! The latency lab: measures beats, wires and taps against the floor of the machine and against peers.
//!
//! Must never spin on more than one processor, run real-time threads without a limit of time, or change
//! anything of the host outside its own processes. What every number means is written in `docs/timing.md`.

pub mod across;
pub mod cases;
pub mod churn;
pub mod command;
pub mod company;
pub mod compare;
pub mod creature;
pub mod crowd;
pub mod cyclictest;
pub mod gate;
pub mod load;
pub mod modules;
pub mod neighbour;
pub mod pair;
pub mod plant;
pub mod probe;
pub mod ratio;
pub mod report;
pub mod rig;
pub mod run;
pub mod scale;
pub mod track;
pub mod workers;
