//! A tower of three levels on a stage: a daemon with level 0, layer processes of levels 1 and 2, and what tests ask
//! of them.
#![allow(dead_code)] // each test file uses its part of it

use std::os::unix::net::UnixStream;

use ipc::clock::Span;
use ipc::control::{Connection, Plug, PlugTap, Reply, Request, Versions};
use ipc::message::Kind;
use ipc::wiring::creature::How;
use ipc::wiring::directory::Listed;
use serde_json::Value;

pub(crate) use crate::scene::on_stage;
use crate::scene::{Player, Scene, wait_for};

/// The name of the running creature.
pub(crate) const TOWER: &str = "tower";

/// Time constant of every tap.
pub(crate) const TAU: Span = Span::millis(300);

/// Level 0: says 1 to itself.
pub(crate) const GROUND: &str = r#"
creature = "tower"
[[layer]]
name = "ground"
level = 0
period = "10ms"
wires = ["low.out -> ground.in"]
[layer.modules]
low = { kind = "constant", value = 1.0, every = "20ms" }
ground = { kind = "gain", factor = 1.0 }
[outsiders]
tap = ["ground.in"]
time_constant_max = "5s"
"#;

/// Level 1: says 2 to level 0, and 7 to whoever listens.
pub(crate) const MIDDLE: &str = r#"
creature = "tower"
[outsiders]
tap = ["relay.in", "beacon.out"]
read = ["relay.out", "mid.out"]
[[layer]]
name = "middle"
level = 1
period = "10ms"
wires = ["mid.out -> relay.in"]
suppress = [{ from = "relay.out", input = "ground.in", time_constant = "300ms" }]
[layer.modules]
mid = { kind = "constant", value = 2.0, every = "20ms" }
relay = { kind = "gain", factor = 1.0 }
beacon = { kind = "constant", value = 7.0, every = "20ms" }
"#;

/// Level 2: says 3 to level 1 and hushes its beacon; hears what level 1 says.
pub(crate) const TOP: &str = r#"
creature = "tower"
[[layer]]
name = "top"
level = 2
period = "10ms"
wires = ["relay.out -> ear.in"]
suppress = [{ from = "high.out", input = "relay.in", time_constant = "300ms" }]
inhibit = [{ from = "hush.out", output = "beacon.out", time_constant = "300ms" }]
[layer.modules]
high = { kind = "constant", value = 3.0, every = "20ms" }
hush = { kind = "constant", value = 0.0, every = "20ms" }
ear = { kind = "gain", factor = 1.0 }
"#;

pub(crate) fn daemon(stage: &Scene) -> Player {
    daemon_with(stage, &[])
}

/// The same, told more.
pub(crate) fn daemon_with(stage: &Scene, arguments: &[&str]) -> Player {
    let file = stage.run.join("tower.toml");
    std::fs::write(&file, GROUND).expect("the stage takes files");
    let file = file.display().to_string();
    let mut all = vec!["--creature", &file];
    all.extend(arguments);
    stage.daemon(TOWER, &all)
}

/// A layer process of this manifest.
pub(crate) fn layer(stage: &Scene, name: &str, manifest: &str) -> Player {
    layer_with(stage, name, manifest, &[])
}

/// The same, told more.
pub(crate) fn layer_with(stage: &Scene, name: &str, manifest: &str, arguments: &[&str]) -> Player {
    let file = stage.run.join(format!("{name}.toml"));
    std::fs::write(&file, manifest).expect("the stage takes files");
    let daemon = std::path::Path::new(env!("CARGO_BIN_EXE_subsumed"));
    let program = daemon.with_file_name("examples").join("layer");
    let manifest = file.display().to_string();
    stage.start_with(program, arguments, &[("LAYER_MANIFEST", &manifest)])
}

pub(crate) fn attached(stage: &Scene, name: &str, manifest: &str) -> Player {
    let player = layer(stage, name, manifest);
    wait_for(
        &format!("{name} is attached, so far: {:?}", player.said()),
        || stage.has_layer(TOWER, name),
    );
    player
}

/// One of a list of the status, by what `key` says.
pub(crate) fn listed(stage: &Scene, list: &str, key: &str, name: &str) -> Value {
    let status = stage.status(TOWER);
    let mut items = status[list].as_array().into_iter().flatten();
    items
        .find(|item| item[key] == name)
        .cloned()
        .unwrap_or(Value::Null)
}

pub(crate) fn says(stage: &Scene, wire: &str) -> f64 {
    listed(stage, "wires", "wire", wire)["value"]
        .as_f64()
        .unwrap_or(f64::NAN)
}

pub(crate) fn messages(stage: &Scene, wire: &str) -> u64 {
    listed(stage, "wires", "wire", wire)["messages"]
        .as_u64()
        .unwrap_or(0)
}

pub(crate) fn tap(stage: &Scene, from: &str) -> Value {
    listed(stage, "taps", "from", from)
}

/// What a newcomer asks that suppresses an input with the one wire that it has.
pub(crate) fn bare(layer: &str, level: u8, from: &str, to: &str) -> Plug {
    let owner = format!("{TOWER}/{layer}");
    Plug {
        layer: layer.into(),
        level,
        period: Span::millis(20),
        pid: 1,
        owner: owner.clone(),
        outputs: vec![port(from, level)],
        taps: vec![PlugTap {
            how: How::Suppress,
            from: from.into(),
            to: to.into(),
            time_constant: TAU,
        }],
        ..Plug::default()
    }
}

pub(crate) fn port(name: &str, level: u8) -> Listed {
    Listed {
        name: name.into(),
        kind: Kind::Number,
        unit: String::new(),
        level: Some(level),
        owner: String::new(),
        index: 0,
        plug: 0,
    }
}

pub(crate) fn greeted(stage: &Scene) -> Connection {
    let stream = UnixStream::connect(stage.socket(TOWER)).expect("the daemon listens");
    let mut connection = Connection::over(stream).expect("a socket can be cloned");
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: "tester".into(),
    };
    let welcome = connection.ask(&hello).expect("the daemon answers");
    assert!(matches!(welcome, Reply::Welcome { .. }), "{welcome:?}");
    connection
}

/// Level 2 without what only a real level 1 has.
pub(crate) fn lonely_top() -> String {
    let top = TOP
        .replace("wires = [\"relay.out -> ear.in\"]\n", "")
        .replace("ear = { kind = \"gain\", factor = 1.0 }\n", "");
    let mut lines: Vec<&str> = top.lines().collect();
    lines.retain(|line| !line.starts_with("inhibit"));
    lines.join("\n")
}
