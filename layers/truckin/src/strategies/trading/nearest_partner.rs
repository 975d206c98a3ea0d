//! Take what is on board to the nearest dealer that buys it; empty, go to the nearest producer.

use super::{Choice, GoTo, partners_elsewhere};
use crate::ootland::{Controller, Corner};
use crate::strategies::notebook::Notebook;

/// Goes by distance alone.
pub type NearestPartner = GoTo<ByDistance>;

/// The shortest way.
pub struct ByDistance;

impl Choice for ByDistance {
    fn target(notebook: &Notebook, body: &Controller<'_>) -> Option<Corner> {
        partners_elsewhere(notebook, body)
            .map(|(corner, _)| corner)
            .min_by_key(|corner| (body.grid().steps(body.corner(), *corner), *corner))
    }
}
