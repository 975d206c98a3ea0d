//! The net of way points: how to get from one place of the office to another on foot.
//!
//! Two places are joined when a disc a little wider than a person can move straight from one to
//! the other. All shortest ways are worked out once, at the start; a step only looks them up.

use crate::config::PERSON_RADIUS_M;
use crate::layout::Layout;
use crate::plane::{Vec2, vec2};
use crate::space::Space;

/// Radius that must be free along a way, m: a person and 3 cm on either side.
pub(crate) const WALK_RADIUS_M: f64 = PERSON_RADIUS_M + 0.03;
/// Radius used from where somebody happens to stand, perhaps against a wall, m: a little less than
/// the person, who slides along what the shoulders brush.
const JOIN_RADIUS_M: f64 = PERSON_RADIUS_M - 0.03;
/// Places tried, nearest first, when looking for a way into the net.
const TRIED_MAX: usize = 12;

pub(crate) struct Ways {
    places: Vec<Vec2>,
    goals: Vec<usize>,
    /// Length of the shortest way, m, from row to column; infinite when there is none.
    length: Vec<f64>,
    /// The place to go to next on the way from row to column.
    next: Vec<usize>,
}

impl Ways {
    pub(crate) fn new(layout: &Layout, space: &Space) -> Ways {
        let places: Vec<Vec2> = layout.places.iter().map(|place| vec2(place.x, place.y)).collect();
        let goals = (0..places.len()).filter(|&i| layout.places[i].goal).collect();
        let count = places.len();
        let mut ways = Ways {
            places,
            goals,
            length: vec![f64::INFINITY; count * count],
            next: vec![0; count * count],
        };
        for from in 0..count {
            for to in 0..=from {
                let (a, b) = (ways.places[from], ways.places[to]);
                if from == to || space.passable(a, b, WALK_RADIUS_M) {
                    let length = (b - a).length();
                    ways.length[from * count + to] = length;
                    ways.length[to * count + from] = length;
                    ways.next[from * count + to] = to;
                    ways.next[to * count + from] = from;
                }
            }
        }
        ways.shorten();
        ways
    }

    /// Floyd's algorithm (Floyd 1962, CACM 5:345).
    fn shorten(&mut self) {
        let count = self.places.len();
        for over in 0..count {
            for from in 0..count {
                for to in 0..count {
                    let length = self.length[from * count + over] + self.length[over * count + to];
                    if length < self.length[from * count + to] {
                        self.length[from * count + to] = length;
                        self.next[from * count + to] = self.next[from * count + over];
                    }
                }
            }
        }
    }

    pub(crate) fn place(&self, index: usize) -> Vec2 {
        self.places[index]
    }

    /// The places that people choose to go to.
    pub(crate) fn goals(&self) -> &[usize] {
        &self.goals
    }

    /// m of the shortest way; infinite when there is none.
    pub(crate) fn length(&self, from: usize, to: usize) -> f64 {
        self.length[from * self.places.len() + to]
    }

    /// The place to walk to next at `from` on the way to `to`.
    pub(crate) fn next(&self, from: usize, to: usize) -> usize {
        self.next[from * self.places.len() + to]
    }

    /// Whether a disc at `at` leaves every way between two places that are joined free to walk.
    pub(crate) fn clear_of(&self, at: Vec2, radius: f64) -> bool {
        let count = self.places.len();
        (0..count).all(|from| {
            (0..from).all(|to| {
                let (a, b) = (self.places[from], self.places[to]);
                // Only a way that is its own shortest is a straight one.
                let straight = self.next[from * count + to] == to;
                !straight || to_segment(at, a, b) > radius + WALK_RADIUS_M
            })
        })
    }

    /// The place by which to join the net from `at` on the way to `goal` (or to nowhere in
    /// particular): the one with the shortest way that can be walked to straight, else the nearest.
    pub(crate) fn join(&self, space: &Space, at: Vec2, goal: Option<usize>) -> Option<usize> {
        let cost = |i: usize| (self.places[i] - at).length() + goal.map_or(0.0, |goal| self.length(i, goal));
        let mut tried = (f64::NEG_INFINITY, 0);
        for _ in 0..TRIED_MAX {
            let (mut best, mut best_cost) = (None, f64::INFINITY);
            for i in 0..self.places.len() {
                let untried = cost(i) > tried.0 || (cost(i) == tried.0 && i > tried.1);
                if untried && cost(i) < best_cost {
                    (best, best_cost) = (Some(i), cost(i));
                }
            }
            let candidate = best?;
            if space.passable(at, self.places[candidate], JOIN_RADIUS_M) {
                return Some(candidate);
            }
            tried = (best_cost, candidate);
        }
        let nearest = |a: &usize, b: &usize| {
            (self.places[*a] - at)
                .length()
                .total_cmp(&(self.places[*b] - at).length())
        };
        (0..self.places.len()).min_by(nearest)
    }
}

/// m from `at` to the line from `a` to `b`.
fn to_segment(at: Vec2, a: Vec2, b: Vec2) -> f64 {
    let (way, to) = (b - a, at - a);
    let share = (to.dot(way) / way.dot(way).max(1e-12)).clamp(0.0, 1.0);
    (to - way * share).length()
}
