//! A game with one seat that is played from outside, action by action, in its own time.
//!
//! ```text
//!  Between ──open: dealers, trucks before the seat──► Open ──act──► Open ──close: trucks after it──► Between
//! ```
//! What is done here is done through the seat's controller: whoever sits there can do no more than a truck.
//! Played like a truck plays, the game is the same to the bit as [`Game::play`] plays it.

use backplane::Action;

use super::action::{Outcome, Refusal, TruckAction};
use super::controller::{Controller, TruckBook};
use super::dealer_manager::Card;
use super::game::Game;

/// A game with an open seat.
pub struct Seat {
    game: Game,
    seat: usize,
    /// How many trucks have had their turn in the slot that is open; nothing between two slots.
    turns: Option<usize>,
}

impl Seat {
    /// Opens a seat of a game that has not begun. The truck that sits there is never asked.
    ///
    /// # Panics
    /// When there is no such seat.
    pub fn new(game: Game, seat: usize) -> Self {
        assert!(seat < game.trucks.len(), "there is no seat {seat}");
        Self {
            game,
            seat,
            turns: None,
        }
    }

    /// The game.
    pub fn game(&self) -> &Game {
        &self.game
    }

    /// Whether it is the seat's turn.
    pub fn is_open(&self) -> bool {
        self.turns.is_some()
    }

    /// What the truck in the seat has.
    pub fn book(&self) -> &TruckBook {
        &self.game.books[self.seat]
    }

    /// What the dealer advertises where the truck is.
    pub fn dealer_here(&self) -> Card {
        self.game.land.manager(self.book().corner).card()
    }

    /// Plays the next slot up to the turn of the seat. Says whether there is one: nothing happens when a slot is
    /// open or the game is over.
    pub fn open(&mut self) -> bool {
        if self.is_open() || self.game.is_over() {
            return false;
        }
        self.game.referee.open_slot(&mut self.game.land);
        let mut at = 0;
        while self.game.referee.seat(at) != self.seat {
            self.play(at);
            at += 1;
        }
        self.game.books[self.seat].begin_slot();
        self.turns = Some(at + 1);
        true
    }

    /// Does one action of the seat's truck through its controller.
    pub fn act(&mut self, action: TruckAction) -> Outcome {
        if !self.is_open() {
            return Outcome::Ignored(Refusal::NoTimeInSlot);
        }
        let Game {
            land, books, referee, ..
        } = &mut self.game;
        action.do_action(&mut Controller::new(&mut books[self.seat], land, referee.clock()))
    }

    /// Ends the turn of the seat and plays the slot to its end; nothing when no slot is open.
    pub fn close(&mut self) {
        let Some(first) = self.turns.take() else {
            return;
        };
        (first..self.game.trucks.len()).for_each(|at| self.play(at));
        self.game.referee.close_slot();
    }

    /// Plays the turn of the truck that comes as the `at`-th.
    fn play(&mut self, at: usize) {
        let Game {
            land,
            books,
            referee,
            trucks,
            ..
        } = &mut self.game;
        let seat = referee.seat(at);
        books[seat].begin_slot();
        if books[seat].left_minutes > 0 {
            trucks[seat].play(&mut Controller::new(&mut books[seat], land, referee.clock()));
        }
    }
}
