//! What the live page shows: the plan, which changes when layers come and go, and the state.

use std::sync::Arc;

use ipc::wiring::creature::{BODY, Creature};
use serde_json::{Value, json};

use crate::gate::Causes;
use crate::plugs::Attached;
use crate::running::Shared;

/// The page's source of what it shows.
pub struct View(pub Arc<Shared>);

impl page::Source for View {
    fn plan(&self) -> String {
        let shared = &self.0;
        let floor = shared.floor();
        let radius = floor.get("robot_radius_m").cloned().unwrap_or(Value::Null);
        json!({
            "creature": shared.name, "floor": floor, "robot_radius_m": radius,
            "graph": graph(&shared.creature, &shared.plugs.attached()),
        })
        .to_string()
    }

    fn state(&self) -> String {
        self.0.status().to_string()
    }

    fn halt(&self) {
        self.0.halt.halt(Causes::EMERGENCY);
        self.0.events.note("halt", None, "emergency stop from the page");
    }

    fn reset(&self) -> Result<(), String> {
        self.0.halt.reset()?;
        self.0.events.note("halt", None, "reset from the page");
        Ok(())
    }
}

/// The wiring as the page draws it.
pub fn graph(creature: &Creature, attached: &[Attached]) -> Value {
    let mut wires: Vec<(String, Vec<String>)> = Vec::new();
    let mut wire = |from: String, to: String| match wires.iter_mut().find(|(f, _)| *f == from) {
        Some((_, tos)) => tos.push(to),
        None => wires.push((from, vec![to])),
    };
    let mut layers = Vec::new();
    let mut taps = Vec::new();
    for layer in &creature.layers {
        let names = |ports: &[ipc::wiring::Port]| ports.iter().map(|p| p.name).collect::<Vec<_>>();
        let modules: Vec<Value> = layer
            .modules
            .iter()
            .map(|m| {
                let d = m.declaration;
                json!({"name": m.name, "kind": d.name, "inputs": names(d.inputs), "outputs": names(d.outputs)})
            })
            .collect();
        layers.push(json!({"name": layer.name, "level": layer.level, "process": null, "modules": modules}));
        layer
            .wires
            .iter()
            .for_each(|w| wire(w.from.to_string(), w.to.to_string()));
        for t in &layer.taps {
            taps.push(json!({
                "kind": t.how, "from": t.from.to_string(), "to": t.to.to_string(),
                "time_constant_ms": t.time_constant.as_millis_f64(),
            }));
        }
    }
    for a in attached {
        let process = format!("pid {}", a.plug.pid);
        layers.push(json!({"name": a.plug.layer, "level": a.plug.level, "process": process, "modules": a.plug.modules}));
        a.plug
            .wires
            .iter()
            .for_each(|(from, to)| wire(from.clone(), to.clone()));
        for t in &a.plug.taps {
            taps.push(json!({
                "kind": t.how, "from": t.from, "to": t.to, "time_constant_ms": t.time_constant.as_millis_f64(),
            }));
        }
    }
    let ports = |ports: &[ipc::wiring::Port]| ports.iter().map(|p| p.name).collect::<Vec<_>>();
    let body = creature.body.as_ref().map(|b| {
        json!({"name": BODY, "kind": b.declaration.name, "inputs": ports(b.declaration.inputs),
               "outputs": ports(b.declaration.outputs)})
    });
    let wires: Vec<Value> = wires
        .into_iter()
        .map(|(from, to)| json!({"from": from, "to": to}))
        .collect();
    json!({"layers": layers, "body": body, "wires": wires, "taps": taps})
}
