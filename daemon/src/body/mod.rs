//! Bodies: what joins wires to the world.
//!
//! A body is two things that meet in a [`link`]: the [`motor`](crate::motor) unit, which beats on a real-time
//! thread and moves messages between the creature's wires and the link, and a [`World`], which may take
//! its time: a simulation, or a driver.
//!
//! ```text
//!   wires ──► motor unit (limits, halt gate) ──► link ──► world ──► link ──► motor unit ──► wires
//! ```
//! Must never know a behaviour.

pub mod office;

use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::wire::{Page, Reader, Writer};
use ipc::wiring::{Declaration, Setting};

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

/// What a body lives in.
pub trait World: Send {
    /// Lives for one period: obeys the newest commands, lets time pass, tells what the sensors say.
    fn tick(&mut self, now: Time, link: &mut WorldEnd);

    /// How it looks now, for those who watch: see the page's `state`.
    fn view(&self) -> serde_json::Value;

    /// What does not change: see the page's `plan`.
    fn floor(&self) -> serde_json::Value;

    /// As what it really is, for tests.
    fn as_any(&mut self) -> &mut dyn std::any::Any;
}

/// No world at all: commands move nothing, sensors say nothing.
#[derive(Clone, Copy, Debug)]
pub struct Nowhere;

impl World for Nowhere {
    fn tick(&mut self, _: Time, _: &mut WorldEnd) {}

    fn view(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn floor(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn as_any(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

/// Every kind of body built in.
pub const BODIES: &[&BodyKind] = &[&office::KIND];

/// The kind called `name`.
pub fn find(name: &str) -> Option<&'static BodyKind> {
    BODIES.iter().find(|k| k.declaration.name == name).copied()
}

/// The motor unit's end of a link.
#[derive(Debug)]
pub struct MotorEnd {
    /// One for each input of the body: commands to the world.
    pub commands: Vec<Writer>,
    /// One for each output of the body: what the sensors say.
    pub sensors: Vec<Reader>,
}

/// The world's end of a link.
#[derive(Debug)]
pub struct WorldEnd {
    /// One for each input of the body.
    pub commands: Vec<Reader>,
    /// One for each output of the body.
    pub sensors: Vec<Writer>,
}

/// A link between a motor unit and its world, in plain memory.
pub fn link(declaration: &'static Declaration) -> (MotorEnd, WorldEnd) {
    let (inputs, outputs) = (declaration.inputs, declaration.outputs);
    let page: Arc<Page> = Page::in_memory(inputs.len() + outputs.len());
    let writer = |i: usize, kind| page.writer(i, kind).expect("a fresh page has all its writers");
    let reader = |i: usize, kind| page.reader(i, kind).expect("the page has this wire");
    let n = inputs.len();
    let motor = MotorEnd {
        commands: inputs
            .iter()
            .enumerate()
            .map(|(i, p)| writer(i, p.kind))
            .collect(),
        sensors: outputs
            .iter()
            .enumerate()
            .map(|(i, p)| reader(n + i, p.kind))
            .collect(),
    };
    let world = WorldEnd {
        commands: inputs
            .iter()
            .enumerate()
            .map(|(i, p)| reader(i, p.kind))
            .collect(),
        sensors: outputs
            .iter()
            .enumerate()
            .map(|(i, p)| writer(n + i, p.kind))
            .collect(),
    };
    (motor, world)
}
