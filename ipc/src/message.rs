//! Messages: what travels on a wire. Fixed length, plain data, every field a number with a unit.
//!
//! Must never hold a pointer or a length: every bit pattern that another process may write is either a
//! valid value or rejected by [`Kind::accepts`] (Brooks 1991 §6.2: fixed-length messages; a sonar map
//! of twelve polar readings is one message).
//!
//! A *kind* is the type of a message, its *words* are the numbers it is made of.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Most words in a message: twelve polar readings, the longest message of the source's robots.
pub const WORDS_MAX: usize = 12;

/// How many sonars are on Allen's ring (Brooks 1991 §6.2).
pub const SONARS: usize = 12;

/// The numbers of a message; those past the kind's own length are zero.
pub type Words = [f64; WORDS_MAX];

/// The type of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Kind {
    /// Nothing but its arrival.
    Pulse = 1,
    /// One bit.
    Bit,
    /// One number.
    Number,
    /// A planar vector (x, y).
    Vector,
    /// A planar vector as (length, bearing in radians).
    Polar,
    /// Twelve ranges, in metres, at bearings of 0°, 30°, … 330° counter-clockwise from straight ahead.
    Map,
    /// A place and a heading (x in metres, y in metres, heading in radians).
    Pose,
}

/// Every kind there is.
pub const KINDS: [Kind; 7] = [
    Kind::Pulse,
    Kind::Bit,
    Kind::Number,
    Kind::Vector,
    Kind::Polar,
    Kind::Map,
    Kind::Pose,
];

impl Kind {
    /// How many words a message of this kind has.
    #[inline]
    pub const fn words(self) -> usize {
        match self {
            Kind::Pulse => 0,
            Kind::Bit | Kind::Number => 1,
            Kind::Vector | Kind::Polar => 2,
            Kind::Pose => 3,
            Kind::Map => SONARS,
        }
    }

    /// Whether a message of this kind is one word: most are.
    #[inline]
    pub const fn single(self) -> bool {
        matches!(self, Kind::Bit | Kind::Number)
    }

    /// The kind's name as it stands in creature files.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Pulse => "pulse",
            Kind::Bit => "bit",
            Kind::Number => "number",
            Kind::Vector => "vector",
            Kind::Polar => "polar",
            Kind::Map => "map",
            Kind::Pose => "pose",
        }
    }

    /// Whether `words` is a message of this kind with every number between `low` and `high`.
    /// Not-a-number and infinities never are; a bit is 0 or 1.
    #[inline]
    ///
    /// # Panics
    /// When there are fewer words than such a message has.
    pub fn accepts(self, words: &[f64], low: f64, high: f64) -> bool {
        let used = &words[..self.words()];
        match self {
            Kind::Bit => used[0] == 0.0 || used[0] == 1.0,
            _ => used.iter().all(|w| w.is_finite() && (low..=high).contains(w)),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A Rust type that travels as a message of one [`Kind`].
pub trait Payload: Copy {
    /// The kind it travels as.
    const KIND: Kind;
    /// The words it is made of.
    fn pack(self) -> Words;
    /// Puts the words it is made of where a message of its kind was before; the others are zero already.
    #[inline]
    fn put(self, words: &mut Words) {
        *words = self.pack();
    }
    /// The value that `words` stand for.
    fn unpack(words: &Words) -> Self;
    /// The one word of a message of a [kind of one word](Kind::single).
    #[inline]
    fn word(self) -> f64 {
        self.pack()[0]
    }
    /// The value that the one word of a message stands for, of a [kind of one word](Kind::single).
    #[inline]
    fn of_word(word: f64) -> Self {
        Self::unpack(&words_of(&[word]))
    }
}

/// A message with no content: its arrival is what it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse;

/// A planar vector; the unit is the port's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Forward component.
    pub x: f64,
    /// Leftward component.
    pub y: f64,
}

/// A planar vector in polar form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polar {
    /// Length; the unit is the port's.
    pub length: f64,
    /// Bearing in radians, counter-clockwise.
    pub bearing: f64,
}

/// A sonar map: ranges in metres at bearings 0°, 30°, … 330° counter-clockwise from straight ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Map {
    /// The twelve ranges, in metres.
    pub ranges: [f64; SONARS],
}

/// Where something is and which way it faces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Radians, counter-clockwise from the x axis.
    pub heading: f64,
}

fn words_of(numbers: &[f64]) -> Words {
    let mut words = [0.0; WORDS_MAX];
    words[..numbers.len()].copy_from_slice(numbers);
    words
}

impl Payload for Pulse {
    const KIND: Kind = Kind::Pulse;
    fn pack(self) -> Words {
        [0.0; WORDS_MAX]
    }
    #[inline]
    fn put(self, _: &mut Words) {}
    #[inline]
    fn unpack(_: &Words) -> Self {
        Pulse
    }
}

impl Payload for bool {
    const KIND: Kind = Kind::Bit;
    fn pack(self) -> Words {
        words_of(&[self.word()])
    }
    #[inline]
    fn put(self, words: &mut Words) {
        words[0] = self.word();
    }
    #[inline]
    fn word(self) -> f64 {
        f64::from(u8::from(self))
    }
    #[inline]
    fn unpack(words: &Words) -> Self {
        Self::of_word(words[0])
    }
    #[inline]
    fn of_word(word: f64) -> Self {
        word != 0.0
    }
}

impl Payload for f64 {
    const KIND: Kind = Kind::Number;
    fn pack(self) -> Words {
        words_of(&[self])
    }
    #[inline]
    fn put(self, words: &mut Words) {
        words[0] = self;
    }
    #[inline]
    fn word(self) -> f64 {
        self
    }
    #[inline]
    fn unpack(words: &Words) -> Self {
        words[0]
    }
    #[inline]
    fn of_word(word: f64) -> Self {
        word
    }
}

impl Payload for Vector {
    const KIND: Kind = Kind::Vector;
    fn pack(self) -> Words {
        words_of(&[self.x, self.y])
    }
    fn unpack(words: &Words) -> Self {
        Vector {
            x: words[0],
            y: words[1],
        }
    }
}

impl Payload for Polar {
    const KIND: Kind = Kind::Polar;
    fn pack(self) -> Words {
        words_of(&[self.length, self.bearing])
    }
    fn unpack(words: &Words) -> Self {
        Polar {
            length: words[0],
            bearing: words[1],
        }
    }
}

impl Payload for Map {
    const KIND: Kind = Kind::Map;
    fn pack(self) -> Words {
        self.ranges
    }
    fn unpack(words: &Words) -> Self {
        Map { ranges: *words }
    }
}

impl Payload for Pose {
    const KIND: Kind = Kind::Pose;
    fn pack(self) -> Words {
        words_of(&[self.x, self.y, self.heading])
    }
    fn unpack(words: &Words) -> Self {
        Pose {
            x: words[0],
            y: words[1],
            heading: words[2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goes_round<T: Payload + PartialEq + fmt::Debug>(value: T) {
        assert_eq!(T::unpack(&value.pack()), value);
        let mut put = [0.0; WORDS_MAX];
        value.put(&mut put);
        assert_eq!(put, value.pack());
        assert!(T::KIND.accepts(&value.pack(), f64::MIN, f64::MAX));
    }

    #[test]
    fn every_payload_goes_round() {
        goes_round(Pulse);
        goes_round(true);
        goes_round(-1.5);
        goes_round(Vector { x: 1.0, y: -2.0 });
        goes_round(Polar {
            length: 1.0,
            bearing: -2.0,
        });
        goes_round(Map {
            ranges: std::array::from_fn(|i| i as f64),
        });
        goes_round(Pose {
            x: 1.0,
            y: 2.0,
            heading: 3.0,
        });
    }

    #[test]
    fn what_is_no_number_or_out_of_range_is_refused() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 10.1, -0.1] {
            assert!(!Kind::Number.accepts(&words_of(&[bad]), 0.0, 10.0), "{bad}");
            assert!(!Kind::Vector.accepts(&words_of(&[1.0, bad]), 0.0, 10.0), "{bad}");
        }
        assert!(!Kind::Bit.accepts(&words_of(&[0.5]), 0.0, 1.0));
        assert!(
            Kind::Pulse.accepts(&[f64::NAN; WORDS_MAX], 0.0, 0.0),
            "a pulse has no words to be wrong"
        );
    }
}
