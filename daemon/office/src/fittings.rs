//! What people do to the office itself: doors open and close, chairs get moved.
//!
//! ```text
//!  door:   Open ──time, and nobody in it──► Closed ──somebody within arm's reach, or time──► Open
//!  chair:  Here ──time, and room for it──► There
//! ```
//! Nothing is ever put on top of anybody, nor where it would bar a way of the people for good. A step in
//! which something changes rebuilds the tree of solids; the others cost a comparison.

use crate::config::FittingsModel;
use crate::discs::Disc;
use crate::layout::{Block, Kind, Layout};
use crate::noise::Noise;
use crate::plane::{Vec2, vec2};
use crate::space::Space;
use crate::ways::Ways;

/// From this gap to a closed door a person opens it, m: an arm's reach.
const REACH_M: f64 = 0.6;
/// A door stays open while anybody is this near to its opening, m.
const CLEAR_M: f64 = 0.3;
/// How far from its first place a chair may end, m.
const STRAY_M: f64 = 0.8;
/// Room left around a chair where it is put, m.
const ROOM_M: f64 = 0.05;
/// How often doors are looked at, s: in it a person walks a quarter of an arm's reach.
const LOOK_S: f64 = 0.2;
/// How soon one looks again when something was in the way, s.
const AGAIN_S: f64 = 2.0;

struct Leaf {
    block: usize,
    due_s: f64,
}

struct Chair {
    block: usize,
    home: Vec2,
    due_s: f64,
}

pub(crate) struct Fittings {
    model: FittingsModel,
    leaves: Vec<Leaf>,
    chairs: Vec<Chair>,
    noise: Noise,
    /// When doors and chairs are looked at next, s.
    doors_s: f64,
    next_s: f64,
}

impl Fittings {
    /// Doors open, chairs as the layout has them.
    pub(crate) fn new(model: FittingsModel, layout: &Layout, noise: Noise) -> Fittings {
        let mut fittings = Fittings {
            model,
            leaves: Vec::new(),
            chairs: Vec::new(),
            noise,
            doors_s: 0.0,
            next_s: 0.0,
        };
        for (block, it) in layout.blocks.iter().enumerate() {
            match it.kind {
                Kind::Leaf => {
                    let due_s = fittings.wait(model.door_open_s);
                    fittings.leaves.push(Leaf { block, due_s });
                }
                Kind::Chair => {
                    let due_s = fittings.wait(model.chair_s);
                    let home = vec2(it.x, it.y);
                    fittings.chairs.push(Chair { block, home, due_s });
                }
                _ => {}
            }
        }
        fittings
    }

    /// A time with this mean, exponentially distributed; for ever where the mean is nought.
    fn wait(&mut self, mean_s: f64) -> f64 {
        if mean_s > 0.0 {
            -mean_s * libm::log(1.0 - self.noise.unit())
        } else {
            f64::INFINITY
        }
    }

    /// One look at everything. `people_from` is where the people begin among the discs.
    pub(crate) fn step(
        &mut self,
        time_s: f64,
        layout: &mut Layout,
        space: &mut Space,
        ways: &Ways,
        discs: &[Disc],
        people_from: usize,
    ) {
        if time_s < self.doors_s {
            return;
        }
        self.doors_s = time_s + LOOK_S;
        for i in 0..self.leaves.len() {
            let Leaf { block, due_s } = self.leaves[i];
            let leaf = &layout.blocks[block];
            let nearest = |discs: &[Disc]| discs.iter().map(|d| gap(leaf, d)).fold(f64::INFINITY, f64::min);
            if space.is_there(block) {
                if time_s < due_s && nearest(&discs[people_from..]) > REACH_M {
                    continue;
                }
                space.put(block, leaf, false);
                self.leaves[i].due_s = time_s + self.wait(self.model.door_open_s);
            } else if time_s >= due_s {
                if nearest(discs) > CLEAR_M {
                    space.put(block, leaf, true);
                    self.leaves[i].due_s = time_s + self.wait(self.model.door_closed_s);
                } else {
                    self.leaves[i].due_s = time_s + AGAIN_S;
                }
            }
        }
        if time_s < self.next_s {
            return;
        }
        self.next_s = time_s + AGAIN_S;
        for i in 0..self.chairs.len() {
            if time_s >= self.chairs[i].due_s {
                self.chairs[i].due_s = time_s + self.wait(self.model.chair_s);
                self.shift(i, layout, space, ways, discs);
            }
        }
    }

    /// Puts a chair elsewhere if there is room for it.
    fn shift(&mut self, index: usize, layout: &mut Layout, space: &mut Space, ways: &Ways, discs: &[Disc]) {
        let Chair { block, home, .. } = self.chairs[index];
        let away = Vec2::at_angle(self.noise.between(0.0, core::f64::consts::TAU));
        let at = home + away * self.noise.between(0.0, STRAY_M);
        let turned = self.noise.between(0.0, core::f64::consts::TAU);
        let chair = &mut layout.blocks[block];
        let radius = libm::hypot(chair.width, chair.depth) / 2.0;
        let taken = Disc { at, radius };
        space.put(block, chair, false);
        let free = space.nearest(at, radius + ROOM_M).is_none()
            && discs.iter().all(|d| d.gap(&taken) > ROOM_M)
            && ways.clear_of(at, radius);
        if free {
            (chair.x, chair.y, chair.angle) = (at.x, at.y, turned);
        }
        space.put(block, chair, true);
    }
}

/// m from a disc's rim to a block.
fn gap(block: &Block, disc: &Disc) -> f64 {
    let (along, to) = (Vec2::at_angle(block.angle), disc.at - vec2(block.x, block.y));
    let x = (libm::fabs(to.dot(along)) - block.width / 2.0).max(0.0);
    let y = (libm::fabs(to.dot(along.left())) - block.depth / 2.0).max(0.0);
    libm::hypot(x, y) - disc.radius
}
