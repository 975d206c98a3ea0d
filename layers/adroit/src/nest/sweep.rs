//! The search pattern: a single round of look-outs over the floor, and where it stands.

use super::geometry::Point;
use super::world::{FLOOR_X_M, FLOOR_Y_M};

/// Look-outs of one round.
const LOOK_OUTS: usize = 8;
/// From the walls to the round, metres: well inside what the eyes see.
const MARGIN_M: f64 = 2.5;
/// A look-out counts as visited from here on, metres; more than an obstacle standing on it keeps the robot away.
const VISITED_M: f64 = 1.1;
/// On its way to one look-out for longer than this in all, whatever came between, the robot gives it up, seconds:
/// twice what the longest way between two of them takes.
const GIVE_UP_S: f64 = 60.0;

/// The look-outs, around the floor.
fn look_outs() -> [Point; LOOK_OUTS] {
    let (west, south) = (MARGIN_M, MARGIN_M);
    let (east, north) = (FLOOR_X_M - MARGIN_M, FLOOR_Y_M - MARGIN_M);
    let (middle_x, middle_y) = (FLOOR_X_M / 2.0, FLOOR_Y_M / 2.0);
    [
        Point::new(west, south),
        Point::new(middle_x, south),
        Point::new(east, south),
        Point::new(east, middle_y),
        Point::new(east, north),
        Point::new(middle_x, north),
        Point::new(west, north),
        Point::new(west, middle_y),
    ]
}

/// One round: which look-outs were visited, and when the round ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sweep {
    visited: [bool; LOOK_OUTS],
    ended_s: Option<f64>,
    /// The look-out gone to, and since when, seconds.
    going: Option<(usize, f64)>,
    /// How long it was on its way to each, in all, until it turned to something else, seconds.
    spent_s: [f64; LOOK_OUTS],
    /// Whether the round showed what was looked for.
    pub(crate) found: bool,
}

impl Sweep {
    /// Marks the look-outs the robot passes.
    pub(crate) fn pass(&mut self, place: Point, now_s: f64) {
        for (visited, look_out) in self.visited.iter_mut().zip(look_outs()) {
            *visited |= place.distance_m(look_out) < VISITED_M;
        }
        self.give_up(now_s);
        if self.over() && self.ended_s.is_none() {
            self.ended_s = Some(now_s);
        }
    }

    /// Notes that the robot is on its way to the next look-out.
    pub(crate) fn go(&mut self, place: Point, now_s: f64) {
        let next = self.nearest(place);
        if self.going.map(|(going, _)| going) != next {
            self.pause(now_s);
            self.going = next.map(|next| (next, now_s));
        }
    }

    /// The robot turned to something else.
    pub(crate) fn pause(&mut self, now_s: f64) {
        if let Some((going, since_s)) = self.going.take() {
            self.spent_s[going] += now_s - since_s;
        }
    }

    /// A look-out that cannot be reached counts as visited: the GSM reports failure, and the round goes on. Being
    /// called away and back does not start its time anew, or two drives could call the robot to and fro for ever.
    fn give_up(&mut self, now_s: f64) {
        if let Some((going, since_s)) = self.going
            && self.spent_s[going] + now_s - since_s > GIVE_UP_S
        {
            self.visited[going] = true;
            self.going = None;
        }
    }

    /// Whether the round is complete.
    pub(crate) fn over(&self) -> bool {
        self.visited.iter().all(|&visited| visited)
    }

    /// Starts a new round when the last one is that long ago, seconds.
    pub(crate) fn renew_after(&mut self, rest_s: f64, now_s: f64) {
        let rest_s = if self.found { 0.0 } else { rest_s };
        if self.ended_s.is_some_and(|ended_s| now_s >= ended_s + rest_s) {
            *self = Self::default();
        }
    }

    /// The look-out to go to next: the nearest not yet visited; `None` when the round is over.
    pub(crate) fn next(&self, place: Point) -> Option<Point> {
        self.nearest(place).map(|next| look_outs()[next])
    }

    fn nearest(&self, place: Point) -> Option<usize> {
        let mut nearest: Option<(f64, usize)> = None;
        for (number, (visited, look_out)) in self.visited.iter().zip(look_outs()).enumerate() {
            let distance_m = place.distance_m(look_out);
            if !visited && nearest.is_none_or(|(best_m, _)| distance_m < best_m) {
                nearest = Some((distance_m, number));
            }
        }
        nearest.map(|(_, number)| number)
    }
}
