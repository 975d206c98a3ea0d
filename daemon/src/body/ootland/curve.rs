//! The trucks' capital over the game, thinned out so that it stays small however long the game.

use serde_json::{Value, json};
use truckin::ootland::Game;

/// Points kept at most; when there are more, every second one goes.
const POINTS_MAX: usize = 240;

/// Capital of every truck, slot by slot.
#[derive(Debug)]
pub(super) struct Curve {
    every: u32,
    slots: Vec<u32>,
    /// One list for each truck, cents.
    cents: Vec<Vec<i64>>,
}

impl Default for Curve {
    fn default() -> Curve {
        Curve {
            every: 1,
            slots: Vec::new(),
            cents: Vec::new(),
        }
    }
}

impl Curve {
    /// Takes in how the trucks stand now.
    pub(super) fn note(&mut self, game: &Game) {
        let slot = game.clock().slot;
        if !slot.is_multiple_of(self.every) && !game.is_over() {
            return;
        }
        self.cents.resize_with(game.books().len(), Vec::new);
        self.slots.push(slot);
        for (line, book) in self.cents.iter_mut().zip(game.books()) {
            line.push(book.capital_cents());
        }
        if self.slots.len() > POINTS_MAX {
            self.every *= 2;
            let kept: Vec<bool> = self
                .slots
                .iter()
                .map(|slot| slot.is_multiple_of(self.every))
                .collect();
            thin(&mut self.slots, &kept);
            self.cents.iter_mut().for_each(|line| thin(line, &kept));
        }
    }

    /// As the page takes it.
    pub(super) fn drawn(&self) -> Value {
        json!({ "slots": self.slots, "cents": self.cents })
    }
}

fn thin<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| *kept.next().expect("one for each"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use truckin::ootland::World;
    use truckin::strategies::all_chromosomes;

    #[test]
    fn it_stays_small_and_keeps_beginning_and_end() {
        let trucks = &all_chromosomes()[300..303];
        let mut game = Game::new(&World::default(), trucks, 1_001, 1, 0);
        let mut curve = Curve::default();
        curve.note(&game);
        while !game.is_over() {
            game.play_slot();
            curve.note(&game);
            assert!(curve.slots.len() <= POINTS_MAX);
        }
        assert_eq!((curve.slots[0], curve.slots.last()), (0, Some(&1_001)));
        assert!(curve.slots.len() > POINTS_MAX / 3, "{}", curve.slots.len());
        let last: Vec<i64> = curve
            .cents
            .iter()
            .filter_map(|line| line.last().copied())
            .collect();
        let books: Vec<i64> = game.books().iter().map(|book| book.capital_cents()).collect();
        assert_eq!(last, books);
    }
}
