//! From checked creatures, sketches of files and layers that joined, to the model of a picture.
//!
//! ```text
//!  checked layer ─┐
//!  joined layer  ─┼─► part: a band, its modules, wires and taps ─► model
//!  sketched layer ┘
//! ```
//! Must never drop a wire or a tap that is named: what is wrong is drawn as wrong.

use ipc::control::Plug;
use ipc::wiring::creature::{Creature, Layer};
use ipc::wiring::sketch::{Marked, Sketch, SketchLayer};

use crate::model::{Band, Model, Tap};

/// What is wrong with it, if something is.
type Fault = Option<String>;

/// A layer as it is drawn, wherever it is known from. Names come in pairs: of a module its own and its kind's, of
/// wires and taps the ends.
struct Part {
    band: Band,
    modules: Vec<([String; 2], Fault)>,
    wires: Vec<([String; 2], Fault)>,
    taps: Vec<([String; 2], Tap, Fault)>,
}

/// The model of a checked creature, with manifests of further layers and layers that joined it.
pub fn of_creature(creature: &Creature, manifests: &[Creature], joined: &[Plug]) -> Model {
    let files = std::iter::once(creature).chain(manifests);
    let parts = files.flat_map(|c| &c.layers).map(of_layer);
    assemble(&creature.name, parts.chain(joined.iter().map(of_plug))).finish()
}

/// The model of what files name, sound or not: the first is the creature, the others add layers.
pub fn of_sketches(sketches: &[Sketch]) -> Model {
    let name = sketches.first().map_or("", |s| &s.name);
    let mut model = assemble(name, sketches.iter().flat_map(|s| &s.layers).map(of_sketch));
    model.faults = sketches.iter().flat_map(|s| s.faults.clone()).collect();
    model.finish()
}

/// Modules first, then wires, then taps, each from the first layer to the last: what a wire ends at is there before
/// it is drawn.
fn assemble(name: &str, parts: impl Iterator<Item = Part>) -> Model {
    let mut model = Model::new(name);
    let mut bands = Vec::new();
    for mut part in parts {
        let modules = std::mem::take(&mut part.modules);
        let band = model.band(part.band.clone());
        for ([module, kind], fault) in modules {
            model.module(band, &module, &kind, fault);
        }
        bands.push((band, part));
    }
    for (band, part) in &mut bands {
        for ([from, to], fault) in part.wires.drain(..) {
            model.wire(*band, &from, &to, fault);
        }
    }
    for (band, part) in bands {
        for ([from, to], tap, fault) in part.taps {
            model.tap(band, &from, &to, tap, fault);
        }
    }
    model
}

fn of_layer(layer: &Layer) -> Part {
    let modules = layer.modules.iter();
    let wires = layer.wires.iter();
    let taps = layer.taps.iter().map(|t| {
        let tap = Tap {
            how: t.how,
            time_constant: Some(t.time_constant),
            level: layer.level,
        };
        ([t.from.to_string(), t.to.to_string()], tap, None)
    });
    Part {
        band: band(&layer.name, layer.level, None),
        modules: modules
            .map(|m| ([m.name.clone(), m.declaration.name.into()], None))
            .collect(),
        wires: wires
            .map(|w| ([w.from.to_string(), w.to.to_string()], None))
            .collect(),
        taps: taps.collect(),
    }
}

fn of_plug(plug: &Plug) -> Part {
    let modules = plug.modules.iter();
    let wires = plug.wires.iter();
    let taps = plug.taps.iter().map(|t| {
        let tap = Tap {
            how: t.how,
            time_constant: Some(t.time_constant),
            level: plug.level,
        };
        ([t.from.clone(), t.to.clone()], tap, None)
    });
    Part {
        band: band(&plug.layer, plug.level, Some(format!("pid {}", plug.pid))),
        modules: modules
            .map(|m| ([m.name.clone(), m.kind.clone()], None))
            .collect(),
        wires: wires
            .map(|(from, to)| ([from.clone(), to.clone()], None))
            .collect(),
        taps: taps.collect(),
    }
}

fn of_sketch(layer: &SketchLayer) -> Part {
    let modules = layer.modules.iter();
    let wires = layer.wires.iter();
    let taps = layer.taps.iter().map(|Marked { part, fault }| {
        let tap = Tap {
            how: part.how,
            time_constant: part.time_constant,
            level: layer.level,
        };
        ([part.from.to_string(), part.to.to_string()], tap, fault.clone())
    });
    Part {
        band: band(&layer.name, layer.level, None),
        modules: modules
            .map(|Marked { part, fault }| ([part.0.clone(), part.1.clone()], fault.clone()))
            .collect(),
        wires: wires
            .map(|Marked { part, fault }| ([part.0.to_string(), part.1.to_string()], fault.clone()))
            .collect(),
        taps: taps.collect(),
    }
}

fn band(name: &str, level: u8, process: Option<String>) -> Band {
    Band {
        name: name.into(),
        level,
        process,
    }
}
