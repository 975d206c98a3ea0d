//! Where people begin.
//!
//! Must never put anybody into a wall, somebody else or the robot.

use crate::config::PERSON_RADIUS_M;
use crate::discs::Disc;
use crate::noise::Noise;
use crate::plane::Vec2;
use crate::space::Space;
use crate::ways::Ways;

/// Places for people to begin at: free, in reach of the way points, not on top of anybody.
pub(crate) fn starting_place(
    space: &Space,
    ways: &Ways,
    size: (f64, f64),
    discs: &[Disc],
    robots: usize,
    noise: &mut Noise,
) -> Option<Vec2> {
    /// Draws before giving up: a floor that is nine tenths full still has a free place in it.
    const DRAWS_MAX: usize = 400;
    for draw in 0..DRAWS_MAX {
        let at = crate::plane::vec2(noise.between(0.0, size.0), noise.between(0.0, size.1));
        let disc = Disc {
            at,
            radius: PERSON_RADIUS_M,
        };
        // Nobody begins within arm's reach of the robot unless the room is too small for that.
        let room = if draw < DRAWS_MAX / 2 { 1.5 } else { 0.3 };
        let free = discs
            .iter()
            .enumerate()
            .all(|(i, other)| disc.gap(other) > if i < robots { room } else { 0.1 })
            && space.nearest(at, PERSON_RADIUS_M + 0.05).is_none();
        let reachable = |place: usize| space.passable(at, ways.place(place), PERSON_RADIUS_M);
        if free && ways.join(space, at, None).is_some_and(reachable) {
            return Some(at);
        }
    }
    None
}
