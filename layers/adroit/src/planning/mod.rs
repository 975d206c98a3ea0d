//! Look-ahead for go-to: a way around the obstacles seen so far, searched between two evaluations.
//!
//! Must never: run inside an evaluation. An evaluation notes where it wants to go and
//! reads the way found before; a target that is new is approached by the sequential RMs until the search,
//! right after that evaluation, has answered. Unknown floor counts as free, and what then stands in the way
//! is met by the sequential RMs or, once seen, by a new search.
//!
//! The source calls the lack of planning a defect to be mended (*Convergence of techniques*).

use std::cell::Cell;

use pathfinding::prelude::astar;

use crate::nest::{CLEARANCE_M, FLOOR_X_M, FLOOR_Y_M, Point, RADIUS_M, World, distance_to_segment_m};

/// Most obstacles remembered; further ones are not planned around.
const KNOWN_MAX: usize = 64;
/// A plan serves a target that moved by less than this, metres.
const SAME_TARGET_M: f64 = 0.15;
/// The robot stands at a point of the way when it is this near, metres.
const THERE_M: f64 = 0.15;
/// Corners around an obstacle.
const CORNERS: usize = 16;
/// From a corner to a wall, metres.
const WALL_M: f64 = RADIUS_M + 0.05;
/// How far from the target the robot may stop, metres.
const SHORT_M: f64 = 0.55;
/// What following a way may lose of the clearance it was searched with, metres.
const SLACK_M: f64 = 0.04;

/// Obstacles seen so far.
#[derive(Clone, Debug, Default)]
pub struct Map {
    known: Vec<(u32, Point, f64)>,
}

impl Map {
    /// Makes room for all obstacles that can be remembered.
    pub(crate) fn make_room(&mut self) {
        self.known.reserve(KNOWN_MAX);
    }

    /// Adds an obstacle once.
    pub(crate) fn add(&mut self, id: u32, place: Point, radius_m: f64) {
        if self.known.len() < KNOWN_MAX && self.known.iter().all(|known| known.0 != id) {
            self.known.push((id, place, radius_m));
        }
    }

    /// Forgets all obstacles.
    pub(crate) fn forget(&mut self) {
        self.known.clear();
    }

    /// Obstacles known.
    #[must_use]
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether no obstacle is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Points around every obstacle, just far enough out to go from one to the next, that are free themselves.
    fn corners(&self) -> Vec<Point> {
        let mut corners = Vec::new();
        for &(_, middle, radius_m) in &self.known {
            let slice_rad = core::f64::consts::TAU / CORNERS as f64;
            let out_m = (radius_m + RADIUS_M + CLEARANCE_M) / libm::cos(slice_rad / 2.0) + 0.01;
            for corner in 0..CORNERS {
                let place = middle.towards(corner as f64 * slice_rad, out_m);
                let inside = |at: f64, size: f64| at > WALL_M && at < size - WALL_M;
                let free = self.known.iter().all(|&(_, other, radius_m)| {
                    other.distance_m(place) >= radius_m + RADIUS_M + CLEARANCE_M
                });
                if free && inside(place.x_m, FLOOR_X_M) && inside(place.y_m, FLOOR_Y_M) {
                    corners.push(place);
                }
            }
        }
        corners
    }

    /// Whether the body gets straight from one place to another, with some of the clearance kept.
    fn clear(&self, from: Point, to: Point, clearance_m: f64) -> bool {
        self.known.iter().all(|&(_, place, radius_m)| {
            let needed_m = (radius_m + RADIUS_M + clearance_m).min(place.distance_m(from) - 1e-9);
            distance_to_segment_m(place, from, to) >= needed_m
        })
    }
}

/// The way found last.
#[derive(Clone, Debug, Default)]
pub struct Planner {
    wanted: Cell<Option<Point>>,
    target: Option<Point>,
    known: usize,
    way: Vec<Point>,
}

impl Planner {
    /// Notes where an evaluation wants to go.
    pub(crate) fn want(&self, target: Point) {
        self.wanted.set(Some(target));
    }

    /// Whether there is a way to a target.
    pub(crate) fn ready_for(&self, target: Point) -> bool {
        !self.way.is_empty()
            && self
                .target
                .is_some_and(|known| known.distance_m(target) < SAME_TARGET_M)
    }

    /// The way found last.
    pub(crate) fn way(&self) -> &[Point] {
        &self.way
    }

    /// The farthest point of the way that can be gone to straight, or the one behind it when the robot stands
    /// there already; `None` when the robot has left the way.
    pub(crate) fn next(&self, from: Point, map: &Map) -> Option<Point> {
        let last = self.way.len().checked_sub(1)?;
        let farthest = (0..=last).rev().find(|&place| {
            let point = self.way[place];
            let to = if place == last {
                short_of(from, point)
            } else {
                point
            };
            map.clear(from, to, CLEARANCE_M - SLACK_M)
        })?;
        let there = self.way[farthest].distance_m(from) < THERE_M;
        Some(self.way[(farthest + usize::from(there)).min(last)])
    }

    fn search(&mut self, from: Point, target: Point, map: &Map) {
        self.target = Some(target);
        self.known = map.len();
        self.way.clear();
        // The last point is the target itself; nothing but the points around obstacles lies between.
        let mut nodes = vec![from];
        nodes.extend(map.corners());
        let goal = nodes.len();
        nodes.push(target);
        let found = astar(
            &0,
            |&here| {
                let reached = |next: usize| {
                    let to = if next == goal {
                        short_of(nodes[here], target)
                    } else {
                        nodes[next]
                    };
                    map.clear(nodes[here], to, CLEARANCE_M)
                };
                let step = |next: usize| (next, micrometres(nodes[here], nodes[next]));
                (1..nodes.len())
                    .filter(|&next| next != here && reached(next))
                    .map(step)
                    .collect::<Vec<_>>()
            },
            |&here| micrometres(nodes[here], target),
            |&here| here == goal,
        );
        if let Some((places, _)) = found {
            self.way.extend(places.iter().skip(1).map(|&place| nodes[place]));
        }
    }
}

/// Where the robot may stop on its way to a target: the arm does the rest.
fn short_of(from: Point, target: Point) -> Point {
    let left_m = (from.distance_m(target) - SHORT_M).max(0.0);
    from.towards(from.direction_rad(target), left_m)
}

/// A distance as a whole number, which a search can add up without rounding.
fn micrometres(from: Point, to: Point) -> u64 {
    (from.distance_m(to) * 1e6) as u64
}

impl World {
    /// Searches a way to where the latest evaluation wanted to go, if there is none yet or more is known now.
    pub(crate) fn plan(&mut self) {
        let Some(target) = self.planner.wanted.take() else {
            return;
        };
        if !self.planning {
            return;
        }
        let fresh = self.planner.ready_for(target) && self.planner.known == self.robot.map.len();
        let on_way = fresh && self.planner.next(self.robot.place, &self.robot.map).is_some();
        if !on_way {
            let mut planner = std::mem::take(&mut self.planner);
            planner.search(self.robot.place, target, &self.robot.map);
            // What was just chosen without a plan is reviewed at once.
            self.interrupt |= !planner.way.is_empty();
            self.planner = planner;
        }
    }
}
