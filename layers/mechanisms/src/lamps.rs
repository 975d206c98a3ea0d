//! Lamps: which RMs of a hierarchy listen and which are active, as two messages, for whoever watches.
//!
//! RM number n, counted from the top level down as `adroit graph` draws them, is bit n mod 48 of word n / 48.
//!
//! Must never be read by a layer: it is for the eye.

use adroit::hierarchy::{Hierarchy, MechanismIndex};
use ipc::message::{Map, SONARS};

/// RMs in one word: a number of 64 bits holds 53 exactly.
const BITS: usize = 48;

/// The lamps of the RMs of which `lit` says so. RMs past the last word have none.
pub(crate) fn lamps(hierarchy: &Hierarchy, lit: impl Fn(MechanismIndex) -> bool) -> Map {
    let mut words = [0_u64; SONARS];
    for number in 0..hierarchy.mechanisms().len().min(SONARS * BITS) {
        let Ok(place) = u16::try_from(number) else { break };
        if lit(MechanismIndex(place)) {
            words[number / BITS] |= 1 << (number % BITS);
        }
    }
    Map {
        ranges: words.map(|word| word as f64),
    }
}
