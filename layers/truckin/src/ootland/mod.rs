//! OOTland: the country the trucks drive in, and everything that enforces its rules.
//!
//! ```text
//!   Referee ──slot──► Dealer ──► Manager ◄──┐
//!      │                                    │ trade
//!      └──turn──► Truck ──► Controller ─────┴──► Land, Ledger
//! ```
//!
//! A truck holds its controller for the length of its turn and nothing else; a dealer holds its
//! manager. Neither ever holds the [`Land`]. There are no floats in here: cents, minutes, millilitres.

pub mod action;
pub mod chance;
pub mod clock;
pub mod controller;
pub mod dealer_manager;
pub mod dealers;
pub mod game;
pub mod grid;
pub mod land;
pub mod ledger;
pub mod phone;
pub mod referee;
pub mod rules;
pub mod seat;
pub mod truck;
pub mod view;
pub mod world;
pub mod world_file;

#[cfg(test)]
mod rules_tests;

pub use action::{Outcome, Refusal, TruckAction, TruckCreature};
pub use chance::Chance;
pub use clock::Clock;
pub use controller::{Controller, TruckBook};
pub use dealer_manager::{Card, Manager};
pub use dealers::{Commodity, Kind};
pub use game::{Game, GameFault, Standing};
pub use grid::{Corner, Direction, Grid};
pub use land::Land;
pub use ledger::{Ledger, LedgerFault};
pub use seat::Seat;
pub use truck::Truck;
pub use view::GameView;
pub use world::World;
