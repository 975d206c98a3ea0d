//! What the live page shows: the plan, which changes when layers come and go, and the state.

use std::sync::Arc;

use ipc::control::Plug;
use ipc::wiring::creature::Creature;
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
        let body = shared.creature.body.as_ref().map(|b| b.declaration.name);
        let radius = floor.get("robot_radius_m").cloned().unwrap_or(Value::Null);
        json!({
            "creature": shared.name, "body": body, "floor": floor, "robot_radius_m": radius,
            "graph": graph(&shared.creature, &shared.plugs.attached()),
            "hierarchies": hierarchies(&shared.creature),
        })
        .to_string()
    }

    fn state(&self) -> String {
        self.0.status().to_string()
    }

    fn timeline(&self, after: u64) -> String {
        let line = self
            .0
            .timeline
            .lock()
            .expect("nobody panics holding the time line");
        line.after(after).to_string()
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

    fn pace(&self, word: &str) -> Result<(), String> {
        let pace = self.0.pace.as_ref();
        pace.ok_or("this world keeps its own pace")?.say(word)
    }
}

/// The hierarchies of releasing mechanisms among the creature's own modules: each drawn, with the names of its RMs
/// in the order in which the wires `active` and `listening` count them.
fn hierarchies(creature: &Creature) -> Vec<Value> {
    let modules = creature.layers.iter().flat_map(|layer| &layer.modules);
    let drawn = modules.filter_map(|module| {
        let drawing = mechanisms::drawing(module.declaration.name)?;
        Some(json!({"module": module.name, "svg": drawing.svg, "names": drawing.names}))
    });
    drawn.collect()
}

/// The wiring as the page shows it: the picture, made by the library that also draws files.
pub fn graph(creature: &Creature, attached: &[Attached]) -> Value {
    let joined: Vec<Plug> = attached.iter().map(|a| a.plug.clone()).collect();
    let model = graph::of_creature(creature, &[], &joined);
    json!({"svg": graph::svg(&graph::draw(&model), graph::Dress::Page)})
}
