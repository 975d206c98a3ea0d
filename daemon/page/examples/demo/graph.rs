//! Allen's wiring: three layers in the manner of the first drawing of them.

use serde_json::{Value, json};

/// The `graph` of `/api/plan`.
pub(crate) fn graph() -> Value {
    json!({
        "layers": [
            {"name": "avoid", "level": 0, "process": null, "modules": [
                module("sonar", "allen.sonar", &["echo"], &["map"]),
                module("collide", "allen.collide", &["map"], &["halt"]),
                module("feelforce", "allen.feelforce", &["map"], &["force"]),
                module("runaway", "allen.runaway", &["force"], &["heading"]),
                module("turn", "allen.turn", &["heading"], &["turn", "heading"]),
                module("forward", "allen.forward", &["heading", "halt"], &["forward", "busy"]),
            ]},
            {"name": "wander", "level": 1, "process": "4711 wander", "modules": [
                module("wander", "allen.wander", &[], &["heading"]),
                module("avoid", "allen.avoid", &["heading", "force"], &["heading"]),
            ]},
            {"name": "explore", "level": 2, "process": null, "modules": [
                module("whenlook", "allen.whenlook", &["busy"], &["look"]),
                module("stereo", "allen.stereo", &["look", "map"], &["free"]),
                module("integrate", "allen.integrate", &["odometry"], &["moved"]),
                module("pathplan", "allen.pathplan", &["free", "moved"], &["heading"]),
            ]},
        ],
        "body": {"inputs": ["turn", "forward"], "outputs": ["sonar", "odometry"]},
        "wires": [
            {"from": "body.sonar", "to": ["sonar.echo"]},
            {"from": "body.odometry", "to": ["integrate.odometry"]},
            {"from": "sonar.map", "to": ["collide.map", "feelforce.map", "stereo.map"]},
            {"from": "collide.halt", "to": ["forward.halt"]},
            {"from": "feelforce.force", "to": ["runaway.force", "avoid.force"]},
            {"from": "runaway.heading", "to": ["turn.heading"]},
            {"from": "turn.turn", "to": ["body.turn"]},
            {"from": "turn.heading", "to": ["forward.heading"]},
            {"from": "forward.forward", "to": ["body.forward"]},
            {"from": "forward.busy", "to": ["whenlook.busy"]},
            {"from": "wander.heading", "to": ["avoid.heading"]},
            {"from": "whenlook.look", "to": ["stereo.look"]},
            {"from": "stereo.free", "to": ["pathplan.free"]},
            {"from": "integrate.moved", "to": ["pathplan.moved"]},
        ],
        "taps": [
            {"kind": "suppress", "from": "avoid.heading", "to": "turn.heading", "time_constant_ms": 2000},
            {"kind": "suppress", "from": "pathplan.heading", "to": "avoid.heading", "time_constant_ms": 5000},
            {"kind": "inhibit", "from": "whenlook.look", "to": "wander.heading", "time_constant_ms": 8000},
        ],
    })
}

fn module(name: &str, kind: &str, inputs: &[&str], outputs: &[&str]) -> Value {
    json!({"name": name, "kind": kind, "inputs": inputs, "outputs": outputs})
}
