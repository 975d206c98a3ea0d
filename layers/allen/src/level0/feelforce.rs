//! `allen.feelforce`: the repulsion of all that the sonars hear, by an inverse-square law.
//!
//! ```text
//!  F = -Σ u(bᵢ) / rᵢ²     for every sonar i with rᵢ < reach     (u: unit vector at the bearing)
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::{Kind, Map, Vector};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::geometry::bearing;

const MAP: In<Map> = In::at(0);
const FORCE: Out<Vector> = Out::at(0);

/// Nearest range that counts, in metres: nearer echoes would be an infinite force.
const NEAREST_M: f64 = 0.2;

/// The kind `allen.feelforce`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(FeelForce::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.feelforce",
    about: "adds up the repulsion of every sonar return, inverse square",
    diagram: "F = -sum of unit(bearing) / range^2 over all ranges below reach",
    inputs: &[Port::new("map", Kind::Map, "a sonar map")
        .unit("m")
        .between(0.0, 100.0)],
    outputs: &[Port::new("force", Kind::Vector, "the force, in the robot's frame").unit("1/m2")],
    parameters: &[
        Parameter::number("reach", 2.0, "returns from farther away do not repel")
            .between(0.1, 100.0)
            .unit("m"),
    ],
};

struct FeelForce {
    reach: f64,
}

impl FeelForce {
    fn new(settings: &Settings<'_>) -> FeelForce {
        FeelForce {
            reach: settings.number("reach"),
        }
    }
}

impl Module for FeelForce {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(map) = beat.arrived(MAP) else { return };
        let mut force = Vector::default();
        for (index, range) in map.ranges.iter().enumerate().filter(|(_, r)| **r < self.reach) {
            let strength = 1.0 / range.max(NEAREST_M).powi(2);
            force.x -= strength * libm::cos(bearing(index));
            force.y -= strength * libm::sin(bearing(index));
        }
        beat.emit(FORCE, force);
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "feeling"
    }
}
