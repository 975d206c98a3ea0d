//! Turn-based subsumption: layers in two phases around a communication backplane.
//!
//! The arbitration of Gantchev 2001, chapter 3, for any creature that acts in turns. It knows neither
//! trucks nor money: the creature brings its primitive actions, what they come to, and a body.
//!
//! ```text
//!   ┌──────────────────────── Selector ────────────────────────┐
//!   │ 1 feedback of every layer   3 go of every layer          │
//!   │ 2 clear the backplane       4 select by fixed priority   │
//!   └───────▲──────────────────────────────┬───────────────────┘
//!           │ what was selected,           │ plans, inhibitions
//!           │ what came of it              ▼
//!        CommunicationBackplane  (one ControlData a layer)
//!           ▲                              │ the selected plan
//!           └── outcomes ── Executor ◄─────┘
//!                              │ do_action, one after the other
//!                              ▼
//!                             body
//! ```
//!
//! This crate must never: allocate in a turn, call a layer from a layer, or act on a body outside
//! the [`Executor`].
//!
//! Local words: *below* means a smaller [`LayerId`]. Below goes first: left alone, the lowest layer
//! that has a plan acts, and a layer above takes over by inhibiting it.

/// The example of the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

mod communication;
mod control;
mod creature;
mod executor;
mod layer;
mod plan;
mod selector;
mod stepped;
mod turn;

pub use communication::{CommunicationBackplane, LAYERS_MAX, Selected};
pub use control::ControlData;
pub use creature::{Action, Creature};
pub use executor::Executor;
pub use layer::{BehaviourLayer, Feedback, LayerId, Proposal};
pub use plan::{ACTIONS_MAX, PlanIsFull, PlanOfAction};
pub use selector::Selector;
pub use stepped::{Phase, SteppedTurn};
pub use turn::{SELECTIONS_MAX, TurnEnd, take_turn};
