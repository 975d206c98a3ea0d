//! JSON Schemas of everything in a recording, so that tools which never heard of it can show and plot it.
//!
//! Must never promise a field that the writer leaves out.

use ipc::message::Kind;
use serde_json::{Value, json};

/// Name of the schema of a beat.
pub const BEAT: &str = "subsumed.Beat";
/// Name of the schema of a tap's message taking effect.
pub const TAP: &str = "subsumed.Tap";
/// Name of the schema of the halt gate.
pub const HALT: &str = "subsumed.Halt";
/// Name of the schema of an overrun.
pub const OVERRUN: &str = "subsumed.Overrun";
/// Name of the schema of a loss.
pub const LOSS: &str = "subsumed.Loss";
/// Name of the schema of a layer that comes or goes.
pub const PLUG: &str = "subsumed.Plug";
/// Name of the schema of a line of the log; Foxglove's own, so that its log panel shows it.
pub const LOG: &str = "foxglove.Log";

/// Name and schema of a message of `kind`.
pub fn of_message(kind: Kind) -> (String, Value) {
    let number = |about: &str| json!({"type": ["number", "null"], "description": about});
    let fields = match kind {
        Kind::Pulse => json!({}),
        Kind::Bit => json!({"value": {"type": "boolean"}}),
        Kind::Number => json!({"value": number("null if it is not a finite number")}),
        Kind::Vector => json!({"x": number("forward"), "y": number("to the left")}),
        Kind::Polar => json!({"length": number(""), "bearing": number("radians, counter-clockwise")}),
        Kind::Map => json!({"ranges": {
            "type": "array", "items": {"type": "number"},
            "description": "at 0, 30, ... 330 degrees, counter-clockwise from straight ahead",
        }}),
        Kind::Pose => {
            json!({"x": number("metres"), "y": number("metres"), "heading": number("radians")})
        }
    };
    let mut properties = json!({
        "number": {"type": "integer", "description": "number on its wire: a gap is a loss"},
        "stamp_ns": {"type": "integer", "description": "when it was written, on the daemon's monotonic clock"},
        "before": {"type": "boolean", "description": "from before the recording: held when it began"},
    });
    if let (Some(all), Value::Object(fields)) = (properties.as_object_mut(), fields) {
        all.extend(fields);
    }
    (format!("subsumed.{}", kind.name()), object(properties))
}

/// Names of a message's numbers; none for a map, which is a list, and for a bit, which is true or false.
pub fn fields(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Number => &["value"],
        Kind::Vector => &["x", "y"],
        Kind::Polar => &["length", "bearing"],
        Kind::Pose => &["x", "y", "heading"],
        Kind::Pulse | Kind::Bit | Kind::Map => &[],
    }
}

/// The schemas of everything that is not a message.
pub fn of_rest() -> [(&'static str, Value); 7] {
    let integer = |about: &str| json!({"type": "integer", "description": about});
    let text = |about: &str| json!({"type": "string", "description": about});
    let pairs = |about: &str| {
        let pair = json!({"type": "array", "items": {"type": "integer"}});
        json!({"type": "array", "items": pair, "description": about})
    };
    let beat = json!({
        "beat": integer("number of the beat, counted from 0"),
        "step_ns": integer("what the modules were told the time is"),
        "commit_ns": integer("stamp of what the beat wrote"),
        "base": {"type": "boolean", "description": "not a beat: what the source held when the recording begins"},
        "saw": pairs("slot of the register (see the metadata), number of the message it took in from its wire"),
        "rejected": pairs("the same, for messages that a suppressor's window kept out"),
        "faults": pairs("the same, for messages that were none"),
        "taps": pairs("tap, message, its stamp, and 0 it took effect, 1 rejected, 2 no message"),
        "joined": {"type": "array", "items": {"type": "object"}, "description": "taps that were joined"},
        "released": {"type": "array", "items": {"type": "integer"}, "description": "layers told to let go"},
        "dropped": {"type": "array", "items": {"type": "integer"}, "description": "slots of outlets inhibited"},
        "causes": integer("of the motor unit: why the halt gate is closed, as bits"),
    });
    let tap = json!({
        "tap": integer("its number"), "kind": text("suppress or inhibit"), "layer": text("whose it is"),
        "from": text("the wire"), "to": text("the port"), "number": integer("the message"),
        "stamp_ns": integer("when it was written"), "until_ns": integer("when its window runs out"),
    });
    let halt = json!({
        "halted": {"type": "boolean"},
        "causes": {"type": "array", "items": {"type": "string"}},
    });
    let overrun = json!({
        "layer": text("the layer, or motor"), "overruns": integer("so far"), "skipped": integer("beats left out"),
    });
    let loss = json!({"what": text("a layer, or a wire"), "lost": integer("beats, or messages, so far")});
    let plug = json!({
        "layer": text("its name"), "attached": {"type": "boolean"}, "number": integer("its number"),
        "plugged": {"type": "object", "description": "what it asked for"},
    });
    let log = json!({
        "timestamp": {"type": "object", "title": "time", "properties": {
            "sec": {"type": "integer"}, "nsec": {"type": "integer"}}},
        "level": integer("2 information, 3 warning"), "message": text(""), "name": text("what it is about"),
        "file": text(""), "line": integer(""), "kind": text("layer, halt, overrun, daemon"),
        "number": integer("its number"), "time_s": {"type": "number", "description": "since the daemon began"},
    });
    [
        (BEAT, object(beat)),
        (TAP, object(tap)),
        (HALT, object(halt)),
        (OVERRUN, object(overrun)),
        (LOSS, object(loss)),
        (PLUG, object(plug)),
        (LOG, object(log)),
    ]
}

fn object(properties: Value) -> Value {
    json!({"type": "object", "properties": properties})
}
