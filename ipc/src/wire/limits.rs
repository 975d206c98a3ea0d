//! Limits: what an input port takes.
//!
//! Must never let a number through that is none, or infinite.

use crate::message::Kind;

/// What an input port takes: kind and range of every number.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The kind of message.
    pub kind: Kind,
    /// Smallest value of any number in it.
    pub low: f64,
    /// Largest value of any number in it.
    pub high: f64,
}

impl Limits {
    #[inline]
    pub(super) fn accept(&self, words: &[f64]) -> bool {
        if self.kind == Kind::Number {
            // The bounds are finite, so what is no number or infinite is not between them.
            return (self.low..=self.high).contains(&words[0]);
        }
        self.kind.accepts(words, self.low, self.high)
    }
}
