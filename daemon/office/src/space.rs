//! The solid part of the office, held by rapier: what a ray hits, what is near, what is in a disc's
//! way. Doors come and go, chairs are moved; nothing here does so by itself.
//!
//! Rapier's colliders, bounding-volume tree and shape queries are used; its bodies and its solver
//! are not. Nothing in the office is light enough to be pushed by a robot of this size, so all that
//! moves are discs under their own power, and a disc that would overlap something is put back to
//! its surface. Discs against discs are solved in closed form (`discs.rs`).
//!
//! Rapier computes in f32: positions in an office are exact to some micrometres.

use crate::layout::{Block, Kind, Layout, Surface};
use crate::plane::{Vec2, vec2};
use rapier2d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier2d::parry::partitioning::{Bvh, BvhBuildStrategy};
use rapier2d::parry::query::{DefaultQueryDispatcher, ShapeCastOptions};
use rapier2d::parry::shape::Ball;
use rapier2d::prelude::{
    ColliderBuilder, ColliderHandle, ColliderSet, Pose, QueryFilter, QueryPipeline, Ray, RigidBodySet, Vector,
};
use std::sync::Arc;

/// Where a ray ended.
pub(crate) struct Hit {
    /// m from the ray's start.
    pub(crate) distance: f64,
    /// The surface's unit normal.
    pub(crate) normal: Vec2,
    /// What it is faced with.
    pub(crate) surface: Surface,
}

/// Something solid close to a point.
pub(crate) struct Near {
    /// Which thing: an index into the names.
    pub(crate) thing: usize,
    /// m from the point to the thing's surface; negative inside it.
    pub(crate) distance: f64,
    /// Unit vector from the surface to the point, or the way out when the point is inside.
    pub(crate) away: Vec2,
}

pub(crate) struct Space {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    tree: Bvh,
    dispatcher: DefaultQueryDispatcher,
    /// The thing that each collider, by its index, is a piece of.
    thing_of: Vec<usize>,
    names: Vec<Arc<str>>,
    /// What each collider is faced with.
    surfaces: Vec<Surface>,
    /// Whether each collider is there: an open door is not.
    there: Vec<bool>,
    /// The four corners of each block, whether it is there or not.
    edges: Vec<[Vec2; 4]>,
    /// Every corner that is open to the air.
    corners: Vec<Vec2>,
}

fn to_f32(v: Vec2) -> Vector {
    Vector::new(v.x as f32, v.y as f32)
}

fn to_f64(v: Vector) -> Vec2 {
    vec2(f64::from(v.x), f64::from(v.y))
}

fn pose_of(block: &Block) -> Pose {
    let turn = Vec2::at_angle(block.angle);
    let rotation = rapier2d::math::Rotation::from_cos_sin_unchecked(turn.x as f32, turn.y as f32);
    Pose::from_parts(to_f32(vec2(block.x, block.y)), rotation)
}

fn edges_of(block: &Block) -> [Vec2; 4] {
    let centre = vec2(block.x, block.y);
    let along = Vec2::at_angle(block.angle) * (block.width / 2.0);
    let across = Vec2::at_angle(block.angle).left() * (block.depth / 2.0);
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(a, b)| centre + along * a + across * b)
}

impl Space {
    pub(crate) fn new(layout: &Layout) -> Space {
        let mut space = Space {
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            tree: Bvh::new(),
            dispatcher: DefaultQueryDispatcher,
            thing_of: Vec::new(),
            names: Vec::new(),
            surfaces: Vec::new(),
            there: Vec::new(),
            edges: Vec::new(),
            corners: Vec::new(),
        };
        for block in &layout.blocks {
            let (half_width, half_depth) = ((block.width / 2.0) as f32, (block.depth / 2.0) as f32);
            let shape = ColliderBuilder::cuboid(half_width, half_depth).position(pose_of(block));
            let (index, _) = space.colliders.insert(shape).into_raw_parts();
            assert_eq!(
                index as usize,
                space.thing_of.len(),
                "colliders are numbered in order"
            );
            let known = space.names.iter().position(|name| **name == *block.name);
            let thing = known.unwrap_or(space.names.len());
            if known.is_none() {
                space.names.push(block.name.as_str().into());
            }
            space.thing_of.push(thing);
            space.surfaces.push(block.surface);
            space.there.push(true);
            space.edges.push(edges_of(block));
        }
        space.grow();
        space
    }

    /// Builds the tree over what is there, and finds the corners that are open to the air.
    fn grow(&mut self) {
        let boxes = self
            .colliders
            .iter()
            .map(|(handle, c)| (handle.into_raw_parts().0 as usize, c.compute_aabb()))
            .filter(|(index, _)| self.there[*index]);
        self.tree = Bvh::from_iter(BvhBuildStrategy::default(), boxes);
        // A corner buried in another block echoes nothing. One where two blocks meet stays: inner
        // corners send sound back where it came from.
        let standing = self.edges.iter().zip(&self.there).filter(|(_, there)| **there);
        let mut corners: Vec<Vec2> = standing.flat_map(|(edges, _)| *edges).collect();
        corners.retain(|&corner| {
            self.nearest(corner, 0.0)
                .is_none_or(|near| near.distance > -0.001)
        });
        self.corners = corners;
    }

    /// Puts block `index` where `block` says, or takes it away. Allocates: call it when a door or a
    /// chair moves, not every step.
    pub(crate) fn put(&mut self, index: usize, block: &Block, there: bool) {
        let handle = ColliderHandle::from_raw_parts(index as u32, 0);
        if let Some(collider) = self.colliders.get_mut(handle) {
            collider.set_position(pose_of(block));
        }
        self.there[index] = there;
        self.edges[index] = edges_of(block);
        self.grow();
    }

    /// Opens every door.
    pub(crate) fn open_all_leaves(&mut self, layout: &Layout) {
        for (there, block) in self.there.iter_mut().zip(&layout.blocks) {
            *there &= block.kind != Kind::Leaf;
        }
        self.grow();
    }

    /// Whether block `index` is there.
    pub(crate) fn is_there(&self, index: usize) -> bool {
        self.there[index]
    }

    fn query(&self) -> QueryPipeline<'_> {
        QueryPipeline {
            dispatcher: &self.dispatcher,
            bvh: &self.tree,
            bodies: &self.bodies,
            colliders: &self.colliders,
            filter: QueryFilter::default(),
        }
    }

    pub(crate) fn name(&self, thing: usize) -> Arc<str> {
        self.names[thing].clone()
    }

    pub(crate) fn things(&self) -> usize {
        self.names.len()
    }

    /// Every corner that is open to the air.
    pub(crate) fn corners(&self) -> &[Vec2] {
        &self.corners
    }

    /// The first surface on the ray within `reach` m; `direction` is a unit vector.
    pub(crate) fn ray(&self, from: Vec2, direction: Vec2, reach: f64) -> Option<Hit> {
        let ray = Ray::new(to_f32(from), to_f32(direction));
        let (collider, hit) = self.query().cast_ray_and_get_normal(&ray, reach as f32, true)?;
        Some(Hit {
            distance: f64::from(hit.time_of_impact),
            normal: to_f64(hit.normal),
            surface: self.surfaces[collider.into_raw_parts().0 as usize],
        })
    }

    /// Whether a disc of `radius` m can be moved straight from `from` to `to`.
    pub(crate) fn passable(&self, from: Vec2, to: Vec2, radius: f64) -> bool {
        let mut options = ShapeCastOptions::with_max_time_of_impact(1.0);
        options.stop_at_penetration = true;
        let start = Pose::from_parts(to_f32(from), rapier2d::math::Rotation::IDENTITY);
        self.query()
            .cast_shape(&start, to_f32(to - from), &Ball::new(radius as f32), options)
            .is_none()
    }

    /// Calls `found` with everything whose surface is within `reach` m of `point`.
    pub(crate) fn each_near(&self, point: Vec2, reach: f64, mut found: impl FnMut(Near)) {
        let (here, r) = (to_f32(point), reach as f32);
        let around = Aabb::new(here - Vector::splat(r), here + Vector::splat(r));
        for leaf in self.tree.leaves(|node| node.aabb().intersects(&around)) {
            let near = self.near(leaf, point, here);
            if near.distance <= reach {
                found(near);
            }
        }
    }

    fn near(&self, leaf: u32, point: Vec2, here: Vector) -> Near {
        let thing = self.thing_of[leaf as usize];
        let handle = ColliderHandle::from_raw_parts(leaf, 0);
        let collider = &self.colliders[handle];
        let surface = collider.shape().project_point(collider.position(), here, false);
        let offset = point - to_f64(surface.point);
        let (distance, sign) = (offset.length(), if surface.is_inside { -1.0 } else { 1.0 });
        Near {
            thing,
            distance: distance * sign,
            away: offset.unit() * sign,
        }
    }

    /// The thing whose surface is nearest to `point`, if it is within `reach` m.
    pub(crate) fn nearest(&self, point: Vec2, reach: f64) -> Option<Near> {
        let mut best: Option<Near> = None;
        self.each_near(point, reach, |near| {
            if best.as_ref().is_none_or(|b| near.distance < b.distance) {
                best = Some(near);
            }
        });
        best
    }

    /// `point` moved out of everything that a disc of `radius` m there would overlap.
    pub(crate) fn pushed_out(&self, point: Vec2, radius: f64) -> Vec2 {
        let mut moved = point;
        let (here, r) = (to_f32(point), radius as f32);
        let around = Aabb::new(here - Vector::splat(r), here + Vector::splat(r));
        for leaf in self.tree.leaves(|node| node.aabb().intersects(&around)) {
            let near = self.near(leaf, moved, to_f32(moved));
            if near.distance < radius {
                moved = moved + near.away * (radius - near.distance);
            }
        }
        moved
    }
}
