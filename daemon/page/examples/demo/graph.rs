//! Allen's wiring: three layers in the manner of the first drawing of them.

use ipc::wiring::Source;
use ipc::wiring::sketch::sketch;
use serde_json::{Value, json};

const CREATURE: &str = r#"
creature = "allen"
[[layer]]
name = "avoid"
level = 0
period = "10ms"
wires = [
  "body.sonar -> sonar.echo",
  "sonar.map -> collide.map, feelforce.map",
  "collide.halt -> forward.halt",
  "feelforce.force -> runaway.force",
  "runaway.heading -> turn.heading",
  "turn.turn -> body.turn",
  "turn.heading -> forward.heading",
  "forward.forward -> body.forward",
]
[layer.modules]
sonar = { kind = "allen.sonar" }
collide = { kind = "allen.collide" }
feelforce = { kind = "allen.feelforce" }
runaway = { kind = "allen.runaway" }
turn = { kind = "allen.turn" }
forward = { kind = "allen.forward" }

[[layer]]
name = "wander"
level = 1
period = "20ms"
wires = ["wander.heading -> avoid.heading", "feelforce.force -> avoid.force"]
suppress = [{ from = "avoid.heading", input = "turn.heading", time_constant = "2s" }]
[layer.modules]
wander = { kind = "allen.wander" }
avoid = { kind = "allen.avoid" }

[[layer]]
name = "explore"
level = 2
period = "20ms"
wires = [
  "forward.busy -> whenlook.busy",
  "whenlook.look -> stereo.look",
  "sonar.map -> stereo.map",
  "stereo.free -> pathplan.free",
  "body.odometry -> integrate.odometry",
  "integrate.moved -> pathplan.moved",
]
suppress = [{ from = "pathplan.heading", input = "avoid.heading", time_constant = "5s" }]
inhibit = [{ from = "whenlook.look", output = "wander.heading", time_constant = "8s" }]
[layer.modules]
whenlook = { kind = "allen.whenlook" }
stereo = { kind = "allen.stereo" }
integrate = { kind = "allen.integrate" }
pathplan = { kind = "allen.pathplan" }
"#;

/// The `graph` of `/api/plan`.
pub(crate) fn graph() -> Value {
    let source = Source::new("demo", CREATURE);
    let model = graph::of_sketches(&[sketch(&source, None)]);
    json!({"svg": graph::svg(&graph::draw(&model), graph::Dress::Page)})
}
