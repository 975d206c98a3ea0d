//! The default dealer: buys nothing, sells nothing.

/// A dealer who trades NONE.
#[derive(Clone, Debug, Default)]
pub struct Idle;

impl Idle {
    /// Lets the slot go by.
    pub fn play(&mut self) {}
}
