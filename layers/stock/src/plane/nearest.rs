//! `nearest`: the nearest thing on a sonar map, in a sector.
//!
//! ```text
//!  out := (range, bearing) of the smallest range with |bearing - ahead| ≤ cone, when a map arrives
//! ```
//! Ranges in metres; bearings in radians, counter-clockwise from straight ahead, from -pi to pi. Of two that are
//! equally near the one of the lower number on the ring is meant. A sector between two sonars has nothing in it:
//! nothing is emitted.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::{Kind, Map, Polar, SONARS};
use ipc::wiring::{Declaration, Parameter};
use std::f64::consts::{PI, TAU};

use crate::declare::{input, out};

const IN: In<Map> = In::at(0);
const OUT: Out<Polar> = Out::at(0);

/// What rounding may do to a bearing of the ring.
const ROUNDING_RAD: f64 = 1e-9;

/// The kinds of this file.
pub const KINDS: &[&ModuleKind] = &[&ModuleKind {
    declaration: &Declaration {
        name: "nearest",
        about: "the nearest thing on a sonar map, in a sector",
        diagram: "out := (range, bearing) of the smallest range with |bearing - ahead| <= cone, when a map arrives",
        inputs: &[input(Kind::Map, "a sonar map").unit("m")],
        outputs: &[out(
            Kind::Polar,
            "range (m) and bearing (rad) of the nearest echo",
        )],
        parameters: &[
            Parameter::number("ahead", 0.0, "middle of the sector")
                .between(-PI, PI)
                .unit("rad"),
            Parameter::number("cone", PI, "half the width of the sector")
                .between(0.0, PI)
                .unit("rad"),
        ],
    },
    build: |s| Box::new(Nearest::new(s)),
}];

struct Nearest {
    /// Bearing of each sonar of the sector.
    sector: [Option<f64>; SONARS],
    seen: bool,
}

impl Nearest {
    fn new(settings: &Settings<'_>) -> Nearest {
        let (ahead, cone) = (settings.number("ahead"), settings.number("cone"));
        let sector = std::array::from_fn(|index| {
            let bearing = wrap(TAU * index as f64 / SONARS as f64);
            (wrap(bearing - ahead).abs() <= cone + ROUNDING_RAD).then_some(bearing)
        });
        Nearest { sector, seen: false }
    }
}

/// The same angle, from -pi to pi.
fn wrap(angle: f64) -> f64 {
    angle - TAU * libm::round(angle / TAU)
}

impl Module for Nearest {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(map) = beat.arrived(IN) else { return };
        let echoes = map.ranges.iter().zip(self.sector);
        let nearest = echoes
            .filter_map(|(range, bearing)| Some((*range, bearing?)))
            .reduce(|nearest, echo| if echo.0 < nearest.0 { echo } else { nearest });
        self.seen = nearest.is_some();
        if let Some((length, bearing)) = nearest {
            beat.emit(OUT, Polar { length, bearing });
        }
    }

    fn reset(&mut self) {
        self.seen = false;
    }

    fn state(&self) -> &'static str {
        if self.seen { "seeing" } else { "blind" }
    }
}
