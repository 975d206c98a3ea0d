//! The referee: announces each slot, dealers before trucks, the order drawn anew each time
//! (Gantchev 2001, 2.1.2.2 and 3.3).

use super::chance::Chance;
use super::clock::Clock;
use super::controller::{Controller, TruckBook};
use super::land::Land;
use super::truck::Truck;

/// Somebody whose turn it was, for those who watch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// All dealers, in the order [`Land::playing`] tells.
    Dealers,
    /// The truck of this seat.
    Truck(usize),
}

/// In charge of one game.
#[derive(Clone, Debug)]
pub struct Referee {
    chance: Chance,
    clock: Clock,
    order: Vec<u16>,
}

impl Referee {
    /// A referee for a game of so many slots and trucks.
    pub fn new(chance: Chance, slots: u32, trucks: usize) -> Self {
        Self {
            chance,
            clock: Clock { slot: 0, slots },
            order: (0..trucks as u16).collect(),
        }
    }

    /// What time it is.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// Whether the time announced at the start has elapsed.
    pub fn is_over(&self) -> bool {
        self.clock.slot >= self.clock.slots
    }

    /// Plays one slot and moves the clock on; tells `watch` of every turn after it was played.
    pub fn play_slot(
        &mut self,
        land: &mut Land,
        trucks: &mut [Truck],
        books: &mut [TruckBook],
        watch: &mut impl FnMut(Turn),
    ) {
        self.open_slot(land);
        watch(Turn::Dealers);
        for at in 0..self.order.len() {
            let seat = self.seat(at);
            let book = &mut books[seat];
            book.begin_slot();
            if book.left_minutes > 0 {
                trucks[seat].play(&mut Controller::new(book, land, self.clock));
            }
            watch(Turn::Truck(seat));
        }
        self.close_slot();
    }

    /// Begins a slot: the dealers play, the order of the trucks is drawn.
    pub(super) fn open_slot(&mut self, land: &mut Land) {
        land.play_dealers(&mut self.chance);
        self.chance.shuffle(&mut self.order);
    }

    /// Whose turn comes as the `at`-th in this slot.
    pub(super) fn seat(&self, at: usize) -> usize {
        usize::from(self.order[at])
    }

    /// Ends a slot: time moves on.
    pub(super) fn close_slot(&mut self) {
        self.clock.slot += 1;
    }
}
