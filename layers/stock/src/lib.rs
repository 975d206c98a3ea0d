//! Stock modules: the simple computations that layers may use (Brooks 1991 §6.2: vector sums, polar conversion,
//! thresholds and the like), so that a creature can be wired in its file alone.
//!
//! A file is a kind of module, or a family of kinds that differ in the type of their messages: the plain name takes
//! numbers, `name.bit`, `name.vector`, … the other types. What holds for all of them:
//!
//! - A module emits when a message arrives or a timer expires, never at every beat, unless its page says so.
//! - With several inputs it uses the newest message of each, and emits when one arrives and all were ever received.
//! - Messages and timers count from the moment a message was written to its wire, not from the beat that saw it.
//! - A result that is no finite number is not emitted; the state is then `refused`.
//! - The reset line puts back the initial state and forgets what was received.
//!
//! Must never know a creature or a body, nor allocate after it was built.

mod answer;
pub mod any;
mod declare;
pub mod event;
mod family;
pub mod logic;
pub mod number;
mod pair;
pub mod plane;
mod schedule;
pub mod signal;
mod single;

use afsm::{Kinds, ModuleKind};

/// Every stock module, family by family.
pub const FAMILIES: &[&[&ModuleKind]] = &[
    any::constant::KINDS,
    any::source::KINDS,
    any::pulse::KINDS,
    any::delay::KINDS,
    any::hold::KINDS,
    any::repeat::KINDS,
    any::latch::KINDS,
    any::select::KINDS,
    any::change::KINDS,
    number::sum::KINDS,
    number::difference::KINDS,
    number::product::KINDS,
    number::quotient::KINDS,
    number::min::KINDS,
    number::max::KINDS,
    number::gain::KINDS,
    number::offset::KINDS,
    number::clamp::KINDS,
    signal::threshold::KINDS,
    signal::compare::KINDS,
    signal::rate_limit::KINDS,
    signal::integrator::KINDS,
    signal::low_pass::KINDS,
    signal::differentiator::KINDS,
    signal::random::KINDS,
    logic::and::KINDS,
    logic::or::KINDS,
    logic::not::KINDS,
    logic::xor::KINDS,
    logic::majority::KINDS,
    logic::edge::KINDS,
    logic::toggle::KINDS,
    logic::flipflop::KINDS,
    event::counter::KINDS,
    event::timer::KINDS,
    event::monoflop::KINDS,
    plane::cartesian::KINDS,
    plane::polar::KINDS,
    plane::split::KINDS,
    plane::join::KINDS,
    plane::nearest::KINDS,
];

/// Every stock kind of module.
pub fn modules() -> impl Iterator<Item = &'static ModuleKind> {
    FAMILIES.iter().copied().flatten().copied()
}

/// The stock kinds alone: what a layer process without modules of its own is built with.
pub fn kinds() -> Kinds {
    Kinds::default().with(modules())
}
