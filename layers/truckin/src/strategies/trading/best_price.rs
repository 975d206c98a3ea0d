//! Go to the best price known, however far: dearest buyer when loaded, cheapest seller when empty.

use std::cmp::Reverse;

use super::{Choice, GoTo, partners_elsewhere};
use crate::ootland::{Controller, Corner};
use crate::strategies::notebook::Notebook;

/// Goes by price alone.
pub type BestPrice = GoTo<ByPrice>;

/// The best price, the nearer of equals.
pub struct ByPrice;

impl Choice for ByPrice {
    fn target(notebook: &Notebook, body: &Controller<'_>) -> Option<Corner> {
        partners_elsewhere(notebook, body)
            .map(|(corner, note)| (note.card.buying_cents - note.card.selling_cents, corner))
            .max_by_key(|(gain, corner)| {
                (
                    *gain,
                    Reverse(body.grid().steps(body.corner(), *corner)),
                    *corner,
                )
            })
            .map(|(_, corner)| corner)
    }
}
