//! Look-ahead for go-to: a way around the obstacles seen so far, searched between two evaluations.
//!
//! Must never: run inside an evaluation. An evaluation notes where it wants to go ([`Planner::want`]) and
//! reads the way found before; a target that is new is approached by the sequential RMs until the search,
//! right after that evaluation, has answered. Unknown floor counts as free, and what then stands in the way
//! is met by the sequential RMs or, once seen, by a new search.
//!
//! The source calls the lack of planning a defect to be mended (*Convergence of techniques*).

use std::cell::Cell;

use pathfinding::prelude::astar;

use crate::nest::{CLEARANCE_M, FLOOR_X_M, FLOOR_Y_M, Point, RADIUS_M, World, distance_to_segment_m};

/// Side of a cell, metres.
const CELL_M: f64 = 0.2;
/// Most obstacles remembered; further ones are not planned around.
const KNOWN_MAX: usize = 64;
/// Cells along the floor.
const CELLS_X: i32 = (FLOOR_X_M / CELL_M) as i32;
const CELLS_Y: i32 = (FLOOR_Y_M / CELL_M) as i32;
/// A plan serves a target that moved by less than this, metres.
const SAME_TARGET_M: f64 = 0.15;
/// The robot stands at a point of the way when it is this near, metres.
const THERE_M: f64 = 0.15;
/// Cost of a straight and of a slanting step, thousandths of a cell.
const STRAIGHT: u32 = 1000;
const SLANTING: u32 = 1414;

/// Obstacles seen so far.
#[derive(Clone, Debug, Default)]
pub struct Map {
    known: Vec<(u32, Point, f64)>,
}

impl Map {
    /// Adds an obstacle once.
    pub(crate) fn add(&mut self, id: u32, place: Point, radius_m: f64) {
        if self.known.len() < KNOWN_MAX && self.known.iter().all(|known| known.0 != id) {
            self.known.push((id, place, radius_m));
        }
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
        let clear = |&point: &Point| map.clear(from, point, CLEARANCE_M / 2.0);
        let farthest = self.way.iter().rposition(clear)?;
        let there = self.way[farthest].distance_m(from) < THERE_M;
        Some(self.way[(farthest + usize::from(there)).min(self.way.len() - 1)])
    }

    fn search(&mut self, from: Point, target: Point, map: &Map) {
        self.target = Some(target);
        self.known = map.len();
        self.way.clear();
        if map.clear(from, target, CLEARANCE_M / 2.0) {
            self.way.push(target);
            return;
        }
        let goal = cell(target);
        let blocked = |at: (i32, i32)| {
            let middle = middle(at);
            at != goal
                && map.known.iter().any(|&(_, place, radius_m)| {
                    let needed_m = radius_m + RADIUS_M + CLEARANCE_M;
                    place.distance_m(middle) < needed_m.min(place.distance_m(from) - CELL_M)
                })
        };
        let found = astar(
            &cell(from),
            |&at| {
                neighbours(at)
                    .filter(|&(next, _)| !blocked(next))
                    .collect::<Vec<_>>()
            },
            |&at| {
                let (across, up) = ((at.0 - goal.0).unsigned_abs(), (at.1 - goal.1).unsigned_abs());
                across.min(up) * SLANTING + (across.max(up) - across.min(up)) * STRAIGHT
            },
            |&at| at == goal,
        );
        if let Some((cells, _)) = found {
            self.way.extend(cells.iter().skip(1).map(|&at| middle(at)));
            self.way.push(target);
        }
    }
}

fn cell(place: Point) -> (i32, i32) {
    let index = |at_m: f64, cells: i32| ((at_m / CELL_M) as i32).clamp(0, cells - 1);
    (index(place.x_m, CELLS_X), index(place.y_m, CELLS_Y))
}

fn middle(cell: (i32, i32)) -> Point {
    Point::new(
        (f64::from(cell.0) + 0.5) * CELL_M,
        (f64::from(cell.1) + 0.5) * CELL_M,
    )
}

fn neighbours((x, y): (i32, i32)) -> impl Iterator<Item = ((i32, i32), u32)> {
    let edge = ((RADIUS_M / CELL_M) as i32).max(1) + 1;
    (-1..=1)
        .flat_map(move |across| (-1..=1).map(move |up| (across, up)))
        .filter_map(move |(across, up)| {
            let next = (x + across, y + up);
            let inside =
                next.0 >= edge && next.1 >= edge && next.0 < CELLS_X - edge && next.1 < CELLS_Y - edge;
            let cost = if across != 0 && up != 0 {
                SLANTING
            } else {
                STRAIGHT
            };
            ((across, up) != (0, 0) && inside).then_some((next, cost))
        })
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
