//! The latency lab: measures beats, wires and taps against the floor of the machine and against peers.
//!
//! Must never spin on more than one processor, run real-time threads without a limit of time, or change
//! anything of the host outside its own processes.

pub mod cases;
pub mod rig;
