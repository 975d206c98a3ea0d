//! Everything that moves is a disc: how one of them comes to rest against the rest of the office.

use crate::plane::Vec2;
use crate::space::Space;

/// How far two things may overlap before a move is refused, m: above the rounding of f32 in the
/// queries, below what anyone can see.
const OVERLAP_MAX_M: f64 = 0.0005;
/// Rounds of pushing out: two walls and two people at once need about three.
const ROUNDS_MAX: usize = 4;

/// The robot or a person, seen from above.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    pub(crate) at: Vec2,
    pub(crate) radius: f64,
}

impl Disc {
    /// m between the two rims; negative when they overlap.
    pub(crate) fn gap(&self, other: &Disc) -> f64 {
        (other.at - self.at).length() - self.radius - other.radius
    }
}

/// Where disc `index` ends that would like to be at `wanted`: there, or slid along what is in its
/// way, or where it was. It moves nothing but itself, and it never ends inside anything if no disc
/// began there. Who does not want to move is not moved, though somebody leans on it by the hair that is let
/// pass: a robot whose wheels stand would otherwise creep half a millimetre a step, and what it crept against
/// would be called its doing.
pub(crate) fn settled(space: &Space, discs: &[Disc], index: usize, wanted: Vec2) -> Vec2 {
    let was = discs[index];
    if wanted == was.at {
        return was.at;
    }
    let others = || {
        discs
            .iter()
            .enumerate()
            .filter(move |&(i, _)| i != index)
            .map(|(_, disc)| disc)
    };
    let mut now = Disc {
        at: wanted,
        radius: was.radius,
    };
    for _ in 0..ROUNDS_MAX {
        let before = now.at;
        now.at = space.pushed_out(now.at, now.radius);
        for other in others() {
            let gap = now.gap(other);
            if gap < 0.0 {
                now.at = now.at + (now.at - other.at).unit() * -gap;
            }
        }
        if now.at == before {
            return now.at;
        }
    }
    let free = space
        .nearest(now.at, now.radius)
        .is_none_or(|n| n.distance > now.radius - OVERLAP_MAX_M)
        && others().all(|other| now.gap(other) > -OVERLAP_MAX_M);
    if free { now.at } else { was.at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Layout;
    use crate::plane::vec2;

    #[test]
    fn who_stands_is_not_crept_along_by_who_leans_on_it() {
        let space = Space::new(&Layout::empty_room(6.0, 6.0));
        let robot = Disc {
            at: vec2(3.0, 3.0),
            radius: 0.2,
        };
        let leaning = Disc {
            at: vec2(3.42 - OVERLAP_MAX_M / 2.0, 3.0),
            radius: 0.22,
        };
        let discs = [robot, leaning];
        let stands = settled(&space, &discs, 0, robot.at);
        assert_eq!(stands, robot.at);
        let drives = settled(&space, &discs, 0, robot.at + vec2(0.006, 0.0));
        assert!(drives.x < robot.at.x, "who drives is stopped at {drives:?}");
    }
}
