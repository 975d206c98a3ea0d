//! What `top` shows at one moment, taken from the daemon's status.
//!
//! Must never ask or wait; a field that the status lacks is shown as nothing.

use serde_json::Value;

use crate::live::short;

/// One moment of a creature.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot {
    pub(crate) title: String,
    /// Causes for which the body is halted; empty if it is free.
    pub(crate) causes: Vec<String>,
    pub(crate) latched: bool,
    /// For how long, in seconds.
    pub(crate) halted_s: f64,
    pub(crate) layers: Vec<LayerRow>,
    pub(crate) taps: Vec<TapRow>,
    pub(crate) wires: Vec<WireRow>,
    pub(crate) events: Vec<String>,
}

/// A thread of the daemon, or an attached process.
#[derive(Clone, Debug, Default)]
pub(crate) struct LayerRow {
    pub(crate) name: String,
    pub(crate) level: Option<u64>,
    pub(crate) period_ms: f64,
    pub(crate) pid: Option<u64>,
    pub(crate) beats: u64,
    pub(crate) overruns: u64,
    pub(crate) p99_us: f64,
    pub(crate) max_us: f64,
    /// Longest latency of each of the last seconds.
    pub(crate) trail_us: Vec<f64>,
}

/// A tap.
#[derive(Clone, Debug, Default)]
pub(crate) struct TapRow {
    pub(crate) suppresses: bool,
    pub(crate) from: String,
    pub(crate) to: String,
    pub(crate) layer: String,
    pub(crate) left_ms: f64,
    pub(crate) delivered: u64,
    pub(crate) rejected: u64,
}

/// A wire.
#[derive(Clone, Debug, Default)]
pub(crate) struct WireRow {
    pub(crate) name: String,
    pub(crate) kind: String,
    pub(crate) unit: String,
    pub(crate) messages: u64,
    pub(crate) rate_hz: f64,
    pub(crate) age_ms: Option<f64>,
    pub(crate) value: String,
}

fn list<'v>(value: &'v Value, key: &str) -> impl Iterator<Item = &'v Value> {
    value[key].as_array().into_iter().flatten()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().into()
}

fn real(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

fn count(value: &Value) -> u64 {
    value.as_u64().unwrap_or(0)
}

impl Snapshot {
    pub(crate) fn of(status: &Value) -> Snapshot {
        let up = real(&status["time_s"]);
        let halt = &status["halt"];
        Snapshot {
            title: format!(
                "{}  pid {}  up {up:.0} s  {}",
                text(&status["creature"]),
                status["pid"],
                text(&status["mode"])
            ),
            causes: list(halt, "causes").map(text).collect(),
            latched: halt["latched"] == true,
            halted_s: up - real(&halt["since_s"]),
            layers: list(status, "layers").map(layer).collect(),
            taps: list(status, "taps").map(tap).collect(),
            wires: list(status, "wires").map(wire).collect(),
            events: list(status, "events")
                .map(|e| format!("[{:9.3}] {}", real(&e["time_s"]), text(&e["text"])))
                .collect(),
        }
    }
}

fn layer(l: &Value) -> LayerRow {
    LayerRow {
        name: text(&l["name"]),
        level: l["level"].as_u64(),
        period_ms: real(&l["period_ms"]),
        pid: l["pid"].as_u64(),
        beats: count(&l["beats"]),
        overruns: count(&l["overruns"]),
        p99_us: real(&l["latency_us"]["p99"]),
        max_us: real(&l["latency_us"]["max"]),
        trail_us: list(l, "trail_us").map(real).collect(),
    }
}

fn tap(t: &Value) -> TapRow {
    TapRow {
        suppresses: t["kind"] == "suppress",
        from: text(&t["from"]),
        to: text(&t["to"]),
        layer: text(&t["layer"]),
        left_ms: real(&t["remaining_ms"]),
        delivered: count(&t["delivered"]),
        rejected: count(&t["rejected"]),
    }
}

fn wire(w: &Value) -> WireRow {
    WireRow {
        name: text(&w["wire"]),
        kind: text(&w["type"]),
        unit: text(&w["unit"]),
        messages: count(&w["messages"]),
        rate_hz: real(&w["rate_hz"]),
        age_ms: w["age_ms"].as_f64(),
        value: short(&w["value"]),
    }
}
