//! The floor: cells that are full or free, and rays that step through them.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Side of a cell, m.
pub(crate) const CELL_M: f64 = 0.1;

/// A floor of cells; everything outside it is full.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Floor {
    wide: usize,
    deep: usize,
    full: Vec<bool>,
}

/// Uniform in [0, 1).
pub(crate) fn unit(random: &mut Pcg32) -> f64 {
    f64::from(random.next_u32()) / 4_294_967_296.0
}

fn cells(metres: f64) -> usize {
    libm::round(metres / CELL_M) as usize
}

impl Floor {
    /// The floor that `random` draws: rows of racks with cross aisles, some pillars, a free yard in the west.
    pub(crate) fn draw(random: &mut Pcg32) -> Floor {
        let (width, depth) = (18.0 + 4.0 * unit(random), 13.0 + 3.0 * unit(random));
        let mut floor = Floor {
            wide: cells(width),
            deep: cells(depth),
            full: Vec::new(),
        };
        floor.full = vec![false; floor.wide * floor.deep];
        let yard = 4.5;
        let mut y = 1.6 + unit(random);
        while y + 2.6 < depth {
            let rack = 0.8 + 0.4 * unit(random);
            let mut x = yard + unit(random);
            while x + 2.0 < width - 1.6 {
                let long = (2.0 + 3.0 * unit(random)).min(width - 1.6 - x);
                floor.fill(x, y, long, rack);
                x += long + 1.5 + 0.8 * unit(random);
            }
            y += rack + 1.6 + 0.9 * unit(random);
        }
        for _ in 0..4 {
            let (x, y) = (
                1.0 + (yard - 2.0) * unit(random),
                1.0 + (depth - 2.0) * unit(random),
            );
            // Never where the robot starts, in the middle of the yard.
            if libm::hypot(x - yard / 2.0, y - depth / 2.0) > 1.5 {
                floor.fill(x, y, 0.4, 0.4);
            }
        }
        floor
    }

    /// A floor with nothing on it, m.
    pub fn empty(width: f64, depth: f64) -> Floor {
        let (wide, deep) = (cells(width), cells(depth));
        Floor {
            wide,
            deep,
            full: vec![false; wide * deep],
        }
    }

    fn fill(&mut self, x: f64, y: f64, width: f64, depth: f64) {
        for row in cells(y)..cells(y + depth).min(self.deep) {
            for column in cells(x)..cells(x + width).min(self.wide) {
                self.full[row * self.wide + column] = true;
            }
        }
    }

    /// Width and depth, m.
    pub fn size(&self) -> (f64, f64) {
        (self.wide as f64 * CELL_M, self.deep as f64 * CELL_M)
    }

    fn is_full(&self, column: i64, row: i64) -> bool {
        let inside = (0..self.wide as i64).contains(&column) && (0..self.deep as i64).contains(&row);
        !inside || self.full[row as usize * self.wide + column as usize]
    }

    /// Every full cell as its middle, m, for whoever draws it.
    pub fn full_cells(&self) -> impl Iterator<Item = (f64, f64)> {
        let middle = |i: usize| (i as f64 + 0.5) * CELL_M;
        let full = (0..self.full.len()).filter(|&i| self.full[i]);
        full.map(move |i| (middle(i % self.wide), middle(i / self.wide)))
    }

    /// m along a ray to the first full cell, at most `reach` (Amanatides and Woo, "A fast voxel traversal
    /// algorithm for ray tracing", 1987).
    pub fn ray(&self, (x, y): (f64, f64), angle: f64, reach: f64) -> f64 {
        let way = [libm::cos(angle), libm::sin(angle)];
        let at = [x / CELL_M, y / CELL_M];
        let mut cell = at.map(|a| libm::floor(a) as i64);
        let step = way.map(|w| if w > 0.0 { 1 } else { -1 });
        let delta = way.map(|w| {
            if w == 0.0 {
                f64::INFINITY
            } else {
                libm::fabs(1.0 / w)
            }
        });
        let mut next = [0, 1].map(|axis| {
            let inside = at[axis] - cell[axis] as f64;
            let left = if step[axis] > 0 { 1.0 - inside } else { inside };
            if delta[axis].is_finite() {
                left * delta[axis]
            } else {
                f64::INFINITY
            }
        });
        let mut gone = 0.0;
        while gone * CELL_M < reach {
            if self.is_full(cell[0], cell[1]) {
                return gone * CELL_M;
            }
            let axis = usize::from(next[1] < next[0]);
            gone = next[axis];
            next[axis] += delta[axis];
            cell[axis] += step[axis];
        }
        reach
    }

    /// The full cell nearest to (x, y) within `radius` m: how far it is, and the unit vector away from it.
    pub fn nearest(&self, x: f64, y: f64, radius: f64) -> Option<(f64, (f64, f64))> {
        let low = |v: f64| libm::floor((v - radius) / CELL_M) as i64;
        let high = |v: f64| libm::floor((v + radius) / CELL_M) as i64;
        let mut best: Option<(f64, (f64, f64))> = None;
        for row in low(y)..=high(y) {
            for column in low(x)..=high(x) {
                if !self.is_full(column, row) {
                    continue;
                }
                let edge = |v: f64, cell: i64| v.clamp(cell as f64 * CELL_M, (cell + 1) as f64 * CELL_M);
                let (dx, dy) = (x - edge(x, column), y - edge(y, row));
                let distance = libm::hypot(dx, dy);
                if distance <= radius && best.is_none_or(|(b, _)| distance < b) {
                    let length = distance.max(1e-9);
                    best = Some((distance, (dx / length, dy / length)));
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_ends_at_the_wall_and_at_what_stands_before_it() {
        let mut floor = Floor::empty(4.0, 3.0);
        assert!((floor.ray((1.0, 1.5), 0.0, 10.0) - 3.0).abs() < 1e-9);
        floor.fill(2.5, 1.0, 0.5, 1.0);
        assert!((floor.ray((1.0, 1.5), 0.0, 10.0) - 1.5).abs() < 1e-9);
        assert!((floor.ray((1.0, 1.5), core::f64::consts::PI, 10.0) - 1.0).abs() < 1e-9);
        assert_eq!(floor.ray((1.0, 1.5), core::f64::consts::PI, 0.4), 0.4);
    }

    #[test]
    fn the_nearest_cell_is_told_with_the_way_from_it() {
        let floor = Floor::empty(4.0, 3.0);
        let (distance, away) = floor.nearest(0.15, 1.52, 0.3).expect("the west edge is near");
        assert!(
            (distance - 0.15).abs() < 1e-9 && away.0 > 0.99,
            "{distance} {away:?}"
        );
        assert!(floor.nearest(2.0, 1.5, 0.3).is_none());
    }
}
