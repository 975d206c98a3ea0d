//! The five kinds of dealer, one file each (Gantchev 2001, 2.1.1.2).
//!
//! A dealer reaches the country only through its manager, which keeps it honest.

mod consumer;
mod gas_station;
mod idle;
mod producer;
mod retailer;

pub use consumer::Consumer;
pub use gas_station::GasStation;
pub use idle::Idle;
pub use producer::Producer;
pub use retailer::Retailer;

use super::dealer_manager::Manager;
use super::ledger::Ledger;

/// What is traded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commodity {
    /// The bulk commodity.
    Crates,
    /// Single pieces, a hundred to the crate.
    Items,
    /// Fuel, by the litre.
    Gas,
}

/// The five kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Kind {
    /// Trades nothing.
    Idle,
    /// Makes and sells crates.
    Producer,
    /// Buys crates, sells items.
    Retailer,
    /// Buys items.
    Consumer,
    /// Sells gas.
    GasStation,
}

impl Kind {
    /// All five, in the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::Idle,
        Self::Producer,
        Self::Retailer,
        Self::Consumer,
        Self::GasStation,
    ];

    /// What such a dealer buys from trucks.
    pub fn buys(self) -> Option<Commodity> {
        match self {
            Self::Retailer => Some(Commodity::Crates),
            Self::Consumer => Some(Commodity::Items),
            Self::Idle | Self::Producer | Self::GasStation => None,
        }
    }

    /// What such a dealer sells to trucks.
    pub fn sells(self) -> Option<Commodity> {
        match self {
            Self::Producer => Some(Commodity::Crates),
            Self::Retailer => Some(Commodity::Items),
            Self::GasStation => Some(Commodity::Gas),
            Self::Idle | Self::Consumer => None,
        }
    }

    /// The word for it in world files and on screens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "none",
            Self::Producer => "producer",
            Self::Retailer => "retailer",
            Self::Consumer => "consumer",
            Self::GasStation => "gas_station",
        }
    }
}

/// A dealer of one of the five kinds.
#[derive(Clone, Debug)]
pub enum Dealer {
    /// Trades nothing.
    Idle(Idle),
    /// Makes and sells crates.
    Producer(Producer),
    /// Buys crates, sells items.
    Retailer(Retailer),
    /// Buys items.
    Consumer(Consumer),
    /// Sells gas.
    GasStation(GasStation),
}

impl Dealer {
    /// Plays one slot.
    #[inline]
    pub fn play(&mut self, manager: &mut Manager, ledger: &mut Ledger) {
        match self {
            Self::Idle(dealer) => dealer.play(),
            Self::Producer(dealer) => dealer.play(manager, ledger),
            Self::Retailer(dealer) => dealer.play(manager, ledger),
            Self::Consumer(dealer) => dealer.play(manager),
            Self::GasStation(dealer) => dealer.play(),
        }
    }
}
