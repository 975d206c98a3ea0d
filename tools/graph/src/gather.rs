//! From checked creatures, sketches of files and layers that joined, to the model of a picture.
//!
//! Must never drop a wire or a tap that is named: what is wrong is drawn as wrong.

use ipc::control::Plug;
use ipc::wiring::creature::{Creature, Layer, PortName};
use ipc::wiring::sketch::{Marked, Sketch};

use crate::model::{Band, Model, Tap};

/// The model of a checked creature, with manifests of further layers and layers that joined it.
pub fn of_creature(creature: &Creature, manifests: &[Creature], joined: &[Plug]) -> Model {
    let mut model = Model::new(&creature.name);
    let layers: Vec<&Layer> = std::iter::once(creature)
        .chain(manifests)
        .flat_map(|c| &c.layers)
        .collect();
    let mut bands = Vec::new();
    for layer in &layers {
        let band = model.band(Band {
            name: layer.name.clone(),
            level: layer.level,
            process: None,
        });
        for module in &layer.modules {
            model.module(band, &module.name, module.declaration.name, None);
        }
        bands.push(band);
    }
    for plug in joined {
        let band = model.band(Band {
            name: plug.layer.clone(),
            level: plug.level,
            process: Some(format!("pid {}", plug.pid)),
        });
        for module in &plug.modules {
            model.module(band, &module.name, &module.kind, None);
        }
        bands.push(band);
    }
    for (layer, &band) in layers.iter().zip(&bands) {
        for wire in &layer.wires {
            model.wire(band, &wire.from.to_string(), &wire.to.to_string(), None);
        }
    }
    for (plug, &band) in joined.iter().zip(&bands[layers.len()..]) {
        for (from, to) in &plug.wires {
            model.wire(band, from, to, None);
        }
    }
    for (layer, &band) in layers.iter().zip(&bands) {
        for t in &layer.taps {
            let tap = Tap {
                how: t.how,
                time_constant: Some(t.time_constant),
                level: layer.level,
            };
            model.tap(band, &t.from.to_string(), &t.to.to_string(), tap, None);
        }
    }
    for (plug, &band) in joined.iter().zip(&bands[layers.len()..]) {
        for t in &plug.taps {
            let tap = Tap {
                how: t.how,
                time_constant: Some(t.time_constant),
                level: plug.level,
            };
            model.tap(band, &t.from, &t.to, tap, None);
        }
    }
    model.finish()
}

/// The model of what files name, sound or not: the first is the creature, the others add layers.
pub fn of_sketches(sketches: &[Sketch]) -> Model {
    let mut model = Model::new(sketches.first().map_or("", |s| &s.name));
    let layers: Vec<_> = sketches.iter().flat_map(|s| &s.layers).collect();
    let mut bands = Vec::new();
    for layer in &layers {
        let band = model.band(Band {
            name: layer.name.clone(),
            level: layer.level,
            process: None,
        });
        for Marked { part, fault } in &layer.modules {
            model.module(band, &part.0, &part.1, fault.clone());
        }
        bands.push(band);
    }
    let spell = PortName::to_string;
    for (layer, &band) in layers.iter().zip(&bands) {
        for Marked { part, fault } in &layer.wires {
            model.wire(band, &spell(&part.0), &spell(&part.1), fault.clone());
        }
    }
    for (layer, &band) in layers.iter().zip(&bands) {
        for Marked { part, fault } in &layer.taps {
            let tap = Tap {
                how: part.how,
                time_constant: part.time_constant,
                level: layer.level,
            };
            model.tap(band, &spell(&part.from), &spell(&part.to), tap, fault.clone());
        }
    }
    model.faults = sketches.iter().flat_map(|s| s.faults.clone()).collect();
    model.finish()
}
