//! A truck over wires: its arbitration runs in a layer of the daemon, its country is the daemon's body.
//!
//! ```text
//!   body "ootland"                                   layer: module "truckin.driver"
//!     Seat ── cab: what is free to know ──────────────► dials ──► hear, clear, propose, select
//!      ▲  └── answer: what came of the last order ────► outcome ──┐            │
//!      └───── order: one action, or the end of the turn ◄─────────┴── act ◄────┘
//! ```
//! Both ends agree on the words of these three messages ([`order`], [`dials`]) and on nothing else: the layer
//! holds no country, the body no layer. Must never give the layer more than a controller tells.
//!
//! An *order* bears a number, one more than the last that was answered, and the slot it is meant for; the body
//! carries out each number once and ignores what comes too late.

pub mod dials;
pub mod driver;
pub mod order;

pub use dials::Dials;
pub use driver::KIND;
pub use order::{Answer, Order};
