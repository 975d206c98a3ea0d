//! Bodies: what joins wires to the world.
//!
//! A body is two things that meet in a [`mod@link`]: the [`motor`](crate::motor) unit, which beats on a real-time
//! thread and moves messages between the creature's wires and the link, and a [`World`], which may take
//! its time: a simulation, or a driver. The two ends lie in one process, or in two ([`process`], [`remote`]).
//!
//! ```text
//!   wires ──► motor unit (limits, halt gate) ──► link ──► (body gate) world ──► link ──► motor unit ──► wires
//! ```
//! Must never know a behaviour.

pub mod gate;
pub mod handover;
pub mod link;
pub mod nest;
pub mod office;
pub mod ootland;
pub mod pace;
pub mod process;
pub mod remote;
mod rover;
pub mod warehouse;

use std::any::Any;
use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::wiring::{Declaration, Setting};

pub use link::{MotorEnd, WorldEnd, link};

/// A kind of body.
#[derive(Clone, Copy, Debug)]
pub struct BodyKind {
    /// Its ports (outputs are sensors, inputs commands) and parameters.
    pub declaration: &'static Declaration,
    /// Which inputs move something: a halt stops these, and they must be fresh.
    pub motion: &'static [usize],
    /// Which of them moves the body forward: what a reflex of level 0 stops.
    pub forward: Option<usize>,
    /// How old a command may be before the world stops by itself.
    pub stale: Span,
    /// Builds the world.
    pub build: Build,
}

/// Builds a world from its checked parameters, a seed, and where the body is to start.
pub type Build = fn(&[Setting], u64, Option<Place>) -> Box<dyn World>;

/// Where a scenario wants the body to start: x and y in metres, heading in radians.
pub type Place = (f64, f64, f64);

/// What a body lives in: what a simulation, or the driver of a real robot, implements.
///
/// Commands come out of the link gated: while the body's own halt gate is closed every motion command reads
/// zero, so a world that obeys [`WorldEnd::motion`] each turn halts without doing anything for it.
pub trait World: Send + Any {
    /// Lives for one period: obeys the newest commands, lets time pass, tells what the sensors say.
    fn tick(&mut self, now: Time, link: &mut WorldEnd);

    /// Stops every actuator: the last thing that is asked before the process leaves.
    fn halt(&mut self) {}

    /// How it looks now, for those who watch: see the page's `state`.
    fn view(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    /// Where its pace is set, if it goes by turns and takes one from the operator.
    fn pace(&self) -> Option<Arc<pace::Pace>> {
        None
    }

    /// What does not change: see the page's `plan`.
    fn floor(&self) -> serde_json::Value {
        serde_json::Value::Null
    }
}

impl dyn World {
    /// As what it really is, for tests.
    pub fn as_any(&mut self) -> &mut dyn Any {
        self
    }
}

/// No world at all: commands move nothing, sensors say nothing.
#[derive(Clone, Copy, Debug)]
pub struct Nowhere;

impl World for Nowhere {
    fn tick(&mut self, _: Time, _: &mut WorldEnd) {}
}

/// Every kind of body built in.
pub const BODIES: &[&BodyKind] = &[&office::KIND, &warehouse::KIND, &nest::KIND, &ootland::KIND];

/// The kind called `name`.
pub fn find(name: &str) -> Option<&'static BodyKind> {
    BODIES.iter().find(|k| k.declaration.name == name).copied()
}

/// One turn of a world: commands are looked at, then the clock; the gate decides, the world lives.
pub fn turn(world: &mut dyn World, link: &mut WorldEnd, clock: impl FnOnce() -> Time) {
    let now = link.begin(clock);
    world.tick(now, link);
    link.end();
}
