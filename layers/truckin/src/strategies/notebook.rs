//! What one layer has seen and been told about the dealers.
//!
//! A layer that wants a memory of the country keeps a notebook of its own and writes it up in its
//! feedback phase; layers never read each other's.

use backplane::Feedback;

use crate::ootland::dealer_manager::Card;
use crate::ootland::{Commodity, Controller, Corner, Grid, Kind, Outcome, TruckCreature};

/// A minute before every game, long enough ago to be stale.
const NEVER: i32 = i32::MIN / 2;

/// What is known of one corner.
#[derive(Clone, Copy, Debug)]
pub struct Note {
    /// What the dealer advertised.
    pub card: Card,
    /// When, in minutes since the start.
    pub minute: i32,
    /// When it last sold or bought less than was asked, in minutes since the start.
    pub short_minute: i32,
    /// Units it bought when it was last offered more than it took; 0 before that.
    pub took_units: i32,
}

/// Notes about corners.
#[derive(Clone, Debug)]
pub struct Notebook {
    grid: Grid,
    notes: Vec<Option<Note>>,
    of_kind: [Vec<Corner>; 5],
    here: Option<Corner>,
    now: i32,
}

impl Notebook {
    /// An empty notebook with room for every corner.
    pub fn new(grid: Grid) -> Self {
        let corners = grid.corners();
        Self {
            grid,
            notes: vec![None; corners],
            of_kind: std::array::from_fn(|_| Vec::with_capacity(corners)),
            here: None,
            now: 0,
        }
    }

    /// Writes up the dealer here and whatever the last plan brought to light.
    pub fn learn(&mut self, heard: &Feedback<'_, TruckCreature>, body: &Controller<'_>) {
        self.now = body.since_start_minutes();
        if let Some(selected) = heard.selected() {
            let mut at = self.here.unwrap_or(body.corner());
            for outcome in selected.outcomes {
                match *outcome {
                    Outcome::Moved { corner, .. } => at = corner,
                    Outcome::Told { corner, card } => self.note(corner, card),
                    Outcome::Bought {
                        commodity,
                        asked,
                        units,
                        ..
                    } if commodity != Commodity::Gas => {
                        self.short(at, units < asked, None);
                    }
                    Outcome::Sold { offered, units, .. } => self.short(at, units < offered, Some(units)),
                    Outcome::Bought { .. } | Outcome::Ignored(_) => {}
                }
            }
        }
        let here = body.corner();
        self.here = Some(here);
        self.note(here, body.dealer_here());
    }

    fn note(&mut self, corner: Corner, card: Card) {
        match &mut self.notes[usize::from(corner.0)] {
            Some(note) => {
                note.card = card;
                note.minute = self.now;
            }
            empty => {
                *empty = Some(Note {
                    card,
                    minute: self.now,
                    short_minute: NEVER,
                    took_units: 0,
                });
                self.of_kind[card.kind as usize].push(corner);
            }
        }
    }

    fn short(&mut self, corner: Corner, short: bool, took: Option<i32>) {
        if let Some(note) = &mut self.notes[usize::from(corner.0)]
            && short
        {
            note.short_minute = self.now;
            note.took_units = took.unwrap_or(note.took_units);
        }
    }

    /// The note about a corner.
    pub fn about(&self, corner: Corner) -> Option<&Note> {
        self.notes[usize::from(corner.0)].as_ref()
    }

    /// Corners known to have a dealer of this kind, in the order they were found.
    pub fn known(&self, kind: Kind) -> &[Corner] {
        &self.of_kind[kind as usize]
    }

    /// Whether at least one dealer of each kind that trades is known.
    pub fn knows_every_kind(&self) -> bool {
        self.of_kind[1..].iter().all(|corners| !corners.is_empty())
    }

    /// Known dealers of a kind with their notes, leaving out those that were short less than
    /// `minutes` ago.
    pub fn ready(&self, kind: Kind, minutes: i32) -> impl Iterator<Item = (Corner, &Note)> + '_ {
        let since = self.now - minutes;
        self.known(kind)
            .iter()
            .filter_map(|corner| Some((*corner, self.about(*corner)?)))
            .filter(move |(_, note)| note.short_minute < since)
    }

    /// The known dealer of a kind that is nearest by road, and the steps to it.
    pub fn nearest(&self, kind: Kind, from: Corner) -> Option<(Corner, i32)> {
        let steps = self
            .known(kind)
            .iter()
            .map(|corner| (*corner, self.grid.steps(from, *corner)));
        steps.min_by_key(|(corner, steps)| (*steps, *corner))
    }

    /// The nearest corner nothing is known of.
    pub fn nearest_unknown(&self, from: Corner) -> Option<Corner> {
        let unknown = self.notes.iter().enumerate().filter(|(_, note)| note.is_none());
        unknown
            .map(|(corner, _)| Corner(corner as u16))
            .min_by_key(|corner| (self.grid.steps(from, *corner), *corner))
    }
}
