//! The highways: avenues, streets, and the corners where they meet (Gantchev 2001, 2.1.1.1).

use std::fmt;

/// Avenues, and streets, at most: a corner's number fits in 16 bits and a trip in a plan's step count.
pub const SIDE_MAX: u16 = 100;

/// An intersection, numbered along the streets from the south-west.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Corner(pub u16);

/// One of the four ways to leave an intersection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the next higher street.
    North,
    /// To the next higher avenue.
    East,
    /// To the next lower street.
    South,
    /// To the next lower avenue.
    West,
}

impl Direction {
    /// All four, clockwise.
    pub const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];

    fn delta(self) -> (i32, i32) {
        match self {
            Self::North => (0, 1),
            Self::East => (1, 0),
            Self::South => (0, -1),
            Self::West => (-1, 0),
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::North => "north",
            Self::East => "east",
            Self::South => "south",
            Self::West => "west",
        })
    }
}

/// The size of the country.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Roads running north and south.
    pub avenues: u16,
    /// Roads running east and west.
    pub streets: u16,
}

impl Grid {
    /// How many intersections there are.
    pub fn corners(self) -> usize {
        usize::from(self.avenues) * usize::from(self.streets)
    }

    /// The corner of an avenue and a street, both counted from 0.
    pub fn corner(self, avenue: u16, street: u16) -> Option<Corner> {
        (avenue < self.avenues && street < self.streets).then(|| Corner(street * self.avenues + avenue))
    }

    /// The avenue and the street of a corner.
    #[inline]
    pub fn place(self, corner: Corner) -> (u16, u16) {
        (corner.0 % self.avenues, corner.0 / self.avenues)
    }

    /// Steps between two corners along the roads.
    #[inline]
    pub fn steps(self, from: Corner, to: Corner) -> i32 {
        let (a, s) = self.place(from);
        let (b, t) = self.place(to);
        i32::from(a.abs_diff(b)) + i32::from(s.abs_diff(t))
    }

    /// Where so many steps in one direction lead; nothing when they would leave the country.
    #[inline]
    pub fn after(self, from: Corner, direction: Direction, steps: u8) -> Option<Corner> {
        let (avenue, street) = self.place(from);
        let (east, north) = direction.delta();
        let avenue = i32::from(avenue) + east * i32::from(steps);
        let street = i32::from(street) + north * i32::from(steps);
        self.corner(u16::try_from(avenue).ok()?, u16::try_from(street).ok()?)
    }

    /// The first straight leg from one corner towards another: along the street first, then the
    /// avenue. Nothing when already there.
    pub fn leg(self, from: Corner, to: Corner) -> Option<(Direction, u8)> {
        let (a, s) = self.place(from);
        let (b, t) = self.place(to);
        let east = i32::from(b) - i32::from(a);
        let north = i32::from(t) - i32::from(s);
        match (east, north) {
            (0, 0) => None,
            (0, north) if north > 0 => Some((Direction::North, north as u8)),
            (0, north) => Some((Direction::South, -north as u8)),
            (east, _) if east > 0 => Some((Direction::East, east as u8)),
            (east, _) => Some((Direction::West, -east as u8)),
        }
    }
}
