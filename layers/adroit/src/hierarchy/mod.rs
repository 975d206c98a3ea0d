//! The hierarchy of releasing mechanisms, and the one recursive evaluation that runs all of it.
//!
//! Must never: know a robot, allocate in an evaluation, read a clock.
//!
//! ```text
//!                 top selector (SRM)
//!        ┌───────────────┼────────────────┐
//!    nest building    refuelling     maintenance        releasing mechanisms (RM)
//!        │               │                │
//!    selector (SRM)   selector         motor control unit (MCU)
//!    ┌───┴───┐           │
//!   ...     ...      subroutine
//! ```
//!
//! Words used here: an RM *listens* when its level is open to its inputs; it is *active* when its selector
//! chose it and its goal selection mechanism (GSM) found what it needs; it *yields* when its output was put
//! to zero so that another may be chosen.

mod arena;
mod evaluation;
mod goal;
mod limits;
mod trace;

pub(crate) use arena::Parts;
pub use arena::{
    Conflicts, Control, Hierarchy, Input, Level, LevelIndex, Mechanism, MechanismIndex, Selection,
};
pub use evaluation::{Evaluation, Outcome, Output, Senses};
pub use goal::Goal;
pub use limits::{DEPTH_MAX, INPUTS_MAX, MECHANISMS_MAX, OUTPUTS_MAX, WIDTH_MAX};
pub use trace::{Trace, Yielded};

/// A primitive stimulus of the body, by its place in the vocabulary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StimulusId(pub u16);

impl StimulusId {
    /// The stimulus that is always present with the value one; no body has to provide it.
    pub const ALWAYS: Self = Self(0);
}

/// A primitive goal criterion of the body ("closest object"), by its place in the vocabulary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CriterionId(pub u16);

/// A goal state that the body can discriminate, by its place in the vocabulary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StateId(pub u16);

/// A motor control unit of the body, by its place in the vocabulary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct McuId(pub u16);
