//! Finding the way of one wire over the grid: the cheapest in length, bends and crossings.
//!
//! Must never let two nets share more than the point where one crosses the other at a right angle.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A point of the grid.
pub(crate) type Point = (usize, usize);

/// Nobody.
const FREE: u32 = u32::MAX;

const BEND: u32 = 6;
const CROSSING: u32 = 9;
const JOINT: u32 = 3;
/// What passing an empty place of a column costs.
const COLUMN: u32 = 6;
/// What running along the line of somebody else's port costs: it should be left to that port.
const HALO: u32 = 2;
/// A tap comes from above where it can.
const FROM_BELOW: u32 = 12;

/// East, south, west, north.
const STEPS: [(isize, isize); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Who runs where.
pub(crate) struct Maze {
    width: usize,
    height: usize,
    /// Lines along which nothing may run downward: edges of columns.
    edges: Vec<bool>,
    /// Cost from the left to each vertical line.
    along: Vec<u32>,
    blocked: Vec<bool>,
    /// Who passes a point from left to right, from top to bottom, or has it all.
    across: Vec<u32>,
    down: Vec<u32>,
    whole: Vec<u32>,
    /// Who should be left alone on a level line.
    halo: Vec<u32>,
    cost: Vec<u32>,
    came: Vec<u8>,
    touched: Vec<usize>,
}

/// Where a way ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    /// At the point, which is left eastward.
    Eastward(Point),
    /// At a circle, from above or below.
    Circle(Point),
}

impl Goal {
    fn point(self) -> Point {
        match self {
            Goal::Eastward(p) | Goal::Circle(p) => p,
        }
    }
}

impl Maze {
    /// A free grid with columns between the given edges.
    pub(crate) fn new(width: usize, height: usize, left: &[usize], right: &[usize]) -> Maze {
        let mut edges = vec![false; width];
        left.iter().chain(right).for_each(|&x| edges[x] = true);
        let mut along = vec![0; width];
        for x in 1..width {
            along[x] = along[x - 1] + if edges[x - 1] && edges[x] { COLUMN } else { 1 };
        }
        let points = width * height;
        Maze {
            width,
            height,
            edges,
            along,
            blocked: vec![false; points],
            across: vec![FREE; points],
            down: vec![FREE; points],
            whole: vec![FREE; points],
            halo: vec![FREE; points],
            cost: vec![u32::MAX; points * 4],
            came: vec![0; points * 4],
            touched: Vec::new(),
        }
    }

    fn at(&self, (x, y): Point) -> usize {
        y * self.width + x
    }

    /// Keeps everybody out of a point.
    pub(crate) fn block(&mut self, p: Point) {
        let at = self.at(p);
        self.blocked[at] = true;
    }

    /// Gives a point to `owner` alone.
    pub(crate) fn give(&mut self, p: Point, owner: u32) {
        let at = self.at(p);
        self.whole[at] = owner;
    }

    /// Lets `owner` pass a point from left to right.
    pub(crate) fn pass(&mut self, p: Point, owner: u32) {
        let at = self.at(p);
        self.across[at] = owner;
    }

    /// Asks others not to run along there.
    pub(crate) fn shade(&mut self, p: Point, owner: u32) {
        let at = self.at(p);
        self.halo[at] = owner;
    }

    /// Enters or removes a way, a list of points one step apart, but for its last point and for `start`.
    pub(crate) fn mark(&mut self, way: &[Point], start: Point, owner: u32, enter: bool) {
        let put = if enter { owner } else { FREE };
        for (k, &p) in way.iter().enumerate().take(way.len() - 1) {
            if p == start {
                continue;
            }
            let at = self.at(p);
            let before = k.checked_sub(1).map(|k| way[k]);
            let after = way.get(k + 1).copied();
            let level = before.is_none_or(|b| b.1 == p.1) && after.is_none_or(|a| a.1 == p.1);
            let upright = before.is_none_or(|b| b.0 == p.0) && after.is_none_or(|a| a.0 == p.0);
            if before.is_none() || !(level || upright) {
                self.whole[at] = put;
            } else if level {
                self.across[at] = put;
            } else {
                self.down[at] = put;
            }
        }
    }

    /// Whether `owner` may leave a point of its own tree there in a new direction.
    pub(crate) fn may_branch(&self, p: Point, owner: u32) -> bool {
        let at = self.at(p);
        let foreign = |who: u32| who != FREE && who != owner;
        let others = [self.across[at], self.down[at], self.whole[at]]
            .into_iter()
            .any(foreign);
        !others && !self.edges[p.0]
    }

    /// Whether `owner`, moving in direction `d`, may enter a point; what it costs to cross whoever is there.
    fn enter(&self, at: usize, d: usize, owner: u32) -> Option<u32> {
        if self.blocked[at] || self.whole[at] != FREE {
            return None;
        }
        let (same, other) = if d.is_multiple_of(2) {
            (self.across[at], self.down[at])
        } else {
            (self.down[at], self.across[at])
        };
        let foreign = d.is_multiple_of(2) && self.halo[at] != FREE && self.halo[at] != owner;
        let shaded = if foreign { HALO } else { 0 };
        match (same, other) {
            (FREE, FREE) => Some(shaded),
            (FREE, other) if other != owner => Some(CROSSING + shaded),
            _ => None,
        }
    }

    fn left_to_go(&self, (x, y): Point, goal: Point) -> u32 {
        self.along[x].abs_diff(self.along[goal.0]) + y.abs_diff(goal.1) as u32
    }

    /// The cheapest way from one of `sources` (with the direction in which its line arrives, if it is the
    /// beginning of a tree) to `goal`, as points one step apart, and its cost.
    pub(crate) fn find(
        &mut self,
        sources: &[(Point, Option<usize>)],
        goal: Goal,
        owner: u32,
    ) -> Option<(Vec<Point>, u32)> {
        for state in self.touched.drain(..) {
            self.cost[state] = u32::MAX;
        }
        let target = goal.point();
        let mut heap = BinaryHeap::new();
        for &(p, arrives) in sources {
            for d in 0..4 {
                // From the stub of an output straight on costs nothing, and back is not possible.
                let start = match arrives {
                    Some(a) if a == d => 0,
                    Some(a) if (a + 2) % 4 == d => continue,
                    Some(_) => BEND,
                    None => JOINT,
                };
                if p == target && arrives.is_some_and(|a| a == d) {
                    return Some((vec![p], 0));
                }
                self.step(p, d, start, None, goal, owner, &mut heap);
            }
        }
        while let Some(Reverse((_, cost, state))) = heap.pop() {
            if self.cost[state] != cost {
                continue;
            }
            let (at, d) = (state / 4, state % 4);
            let p = (at % self.width, at / self.width);
            if p == target {
                return Some((self.trace(state), cost));
            }
            let crossing = [self.across[at], self.down[at]].into_iter().any(|w| w != FREE);
            for turn in [0, 1, 3] {
                let to = (d + turn) % 4;
                if turn != 0 && (crossing || self.edges[p.0]) {
                    continue;
                }
                let bend = if turn == 0 { 0 } else { BEND };
                self.step(p, to, cost + bend, Some(state), goal, owner, &mut heap);
            }
        }
        None
    }

    #[allow(clippy::too_many_arguments)]
    fn step(
        &mut self,
        p: Point,
        d: usize,
        cost: u32,
        from: Option<usize>,
        goal: Goal,
        owner: u32,
        heap: &mut BinaryHeap<Reverse<(u32, u32, usize)>>,
    ) {
        let vertical = !d.is_multiple_of(2);
        if vertical && self.edges[p.0] {
            return;
        }
        let (Some(x), Some(y)) = (
            p.0.checked_add_signed(STEPS[d].0),
            p.1.checked_add_signed(STEPS[d].1),
        ) else {
            return;
        };
        if x >= self.width || y >= self.height {
            return;
        }
        let next = (x, y);
        let at = self.at(next);
        let extra = if next == goal.point() {
            match goal {
                Goal::Eastward(_) if d == 2 => return,
                Goal::Eastward(_) if d == 0 => 0,
                Goal::Eastward(_) => BEND,
                Goal::Circle(_) if d == 1 => 0,
                Goal::Circle(_) if d == 3 => FROM_BELOW,
                Goal::Circle(_) => return,
            }
        } else {
            let Some(extra) = self.enter(at, d, owner) else {
                return;
            };
            extra
        };
        let length = if vertical {
            1
        } else {
            self.along[x].abs_diff(self.along[p.0])
        };
        let cost = cost + length + extra;
        let state = at * 4 + d;
        if self.cost[state] <= cost {
            return;
        }
        if self.cost[state] == u32::MAX {
            self.touched.push(state);
        }
        self.cost[state] = cost;
        // Where it came from: a direction, or 4 for a source.
        self.came[state] = from.map_or(4, |s| (s % 4) as u8);
        let guess = cost + self.left_to_go(next, goal.point());
        heap.push(Reverse((guess, cost, state)));
    }

    fn trace(&self, mut state: usize) -> Vec<Point> {
        let mut way = Vec::new();
        loop {
            let (at, d) = (state / 4, state % 4);
            let p = (at % self.width, at / self.width);
            way.push(p);
            let before = (
                p.0.wrapping_add_signed(-STEPS[d].0),
                p.1.wrapping_add_signed(-STEPS[d].1),
            );
            if self.came[state] == 4 {
                way.push(before);
                way.reverse();
                return way;
            }
            state = self.at(before) * 4 + self.came[state] as usize;
        }
    }
}
