//! The map: which dealer stands at which corner. Only controllers and the referee hold it.

use super::chance::Chance;
use super::dealer_manager::{Card, Manager};
use super::dealers::{Dealer, Idle, Kind};
use super::grid::{Corner, Grid};
use super::ledger::{Holdings, Ledger};

/// One intersection: a dealer and its manager.
#[derive(Clone, Debug)]
pub struct Stand {
    /// Keeps the books.
    pub manager: Manager,
    /// Decides.
    pub dealer: Dealer,
}

/// The whole country.
#[derive(Clone, Debug)]
pub struct Land {
    grid: Grid,
    stands: Vec<Stand>,
    /// Corners whose dealer trades something, in the order they play this slot.
    playing: Vec<Corner>,
    /// The books of the country.
    pub(crate) ledger: Ledger,
}

impl Land {
    /// A country with one stand for each corner of the grid.
    ///
    /// # Panics
    /// When the number of stands is not the number of corners.
    pub(crate) fn new(grid: Grid, stands: Vec<Stand>) -> Self {
        assert_eq!(stands.len(), grid.corners(), "one dealer at every corner");
        let playing = stands
            .iter()
            .enumerate()
            .filter(|(_, stand)| stand.manager.kind() != Kind::Idle)
            .map(|(corner, _)| Corner(corner as u16))
            .collect();
        Self {
            grid,
            stands,
            playing,
            ledger: Ledger::default(),
        }
    }

    /// A country in which nobody trades anything.
    pub(crate) fn empty(grid: Grid) -> Self {
        let idle = Stand {
            manager: Manager::idle(),
            dealer: Dealer::Idle(Idle),
        };
        Self::new(grid, vec![idle; grid.corners()])
    }

    /// Has the dealer at a corner show this card and nothing behind it.
    pub(crate) fn advertise(&mut self, corner: Corner, card: Card) {
        self.stands[usize::from(corner.0)].manager = Manager::of_card(card);
    }

    /// Has nobody trade at a corner any more.
    pub(crate) fn close(&mut self, corner: Corner) {
        self.stands[usize::from(corner.0)].manager = Manager::idle();
    }

    /// The size of the country.
    #[inline]
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The dealer at a corner, through its manager.
    #[inline]
    pub fn manager(&self, corner: Corner) -> &Manager {
        &self.stands[usize::from(corner.0)].manager
    }

    #[inline]
    pub(crate) fn trade(&mut self, corner: Corner) -> (&mut Manager, &mut Ledger) {
        (&mut self.stands[usize::from(corner.0)].manager, &mut self.ledger)
    }

    /// Corners whose dealer trades something, in the order they played last.
    pub fn playing(&self) -> &[Corner] {
        &self.playing
    }

    /// Every dealer plays one slot, in an order drawn anew. Those who trade nothing have nothing to
    /// play and are left out of the draw.
    pub(crate) fn play_dealers(&mut self, chance: &mut Chance) {
        chance.shuffle(&mut self.playing);
        for corner in &self.playing {
            let Stand { manager, dealer } = &mut self.stands[usize::from(corner.0)];
            dealer.play(manager, &mut self.ledger);
        }
    }

    /// What all dealers hold together.
    pub(crate) fn holdings(&self) -> Holdings {
        let mut sum = Holdings {
            least: i64::MAX,
            ..Holdings::default()
        };
        for corner in &self.playing {
            let manager = self.manager(*corner);
            let (crates, items) = (i64::from(manager.crates()), i64::from(manager.items()));
            sum.cents += manager.capital_cents();
            sum.crates += crates;
            sum.items += items;
            sum.least = sum.least.min(manager.capital_cents()).min(crates).min(items);
            sum.least = sum.least.min(i64::from(manager.wanted_items()));
        }
        sum
    }
}
