//! Looking at a running creature, and stopping it.

use ipc::control::{self, Connection, Reply, Request};
use serde_json::{Value, json};

type Done = Result<(), String>;

pub(crate) fn call(creature: &str) -> Result<Connection, String> {
    control::call(creature, "subsumectl").map_err(|e| e.to_string())
}

fn ask(creature: &str, request: &Request) -> Result<Reply, String> {
    match call(creature)?
        .ask(request)
        .map_err(|e| format!("the daemon does not answer: {e}"))?
    {
        Reply::Refused { reasons } => Err(reasons.join("; ")),
        reply => Ok(reply),
    }
}

pub(crate) fn ask_status(creature: &str) -> Result<Value, String> {
    match ask(creature, &Request::Status)? {
        Reply::Status(status) => Ok(status),
        other => Err(format!(
            "the daemon answered {other:?} to a question for its status"
        )),
    }
}

fn list<'v>(value: &'v Value, key: &str) -> impl Iterator<Item = &'v Value> {
    value[key].as_array().into_iter().flatten()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or("-")
}

pub(crate) fn status(creature: &str, as_json: bool) -> Done {
    let status = ask_status(creature)?;
    if as_json {
        println!("{status}");
        return Ok(());
    }
    let up = status["time_s"].as_f64().unwrap_or(0.0);
    println!(
        "{} (pid {}), up {up:.0} s, {}",
        text(&status["creature"]),
        status["pid"],
        text(&status["mode"])
    );
    for note in list(&status, "notes") {
        println!("  {}", text(note));
    }
    let halt = &status["halt"];
    let causes: Vec<&str> = list(halt, "causes").map(text).collect();
    match causes.as_slice() {
        [] => println!("halt: no"),
        some => {
            let latched = if halt["latched"] == true {
                " (latched: `subsumectl reset` ends it)"
            } else {
                ""
            };
            println!("halt: {}{latched}", some.join(", "));
        }
    }
    println!();
    println!(
        "{:<12} {:>5} {:>9} {:>10} {:>8} {:>8} {:>9} {:>9} {:>9}",
        "layer", "level", "period", "beats", "overrun", "skipped", "p50 us", "p99 us", "max us"
    );
    for layer in list(&status, "layers") {
        let level = layer["level"].as_u64().map_or("-".into(), |l| l.to_string());
        let period = format!("{} ms", layer["period_ms"]);
        let name = text(&layer["name"]);
        if layer["attached"] == true {
            println!(
                "{name:<12} {level:>5} {period:>9}   attached, pid {}",
                layer["pid"]
            );
            continue;
        }
        let us = |key: &str| layer["latency_us"][key].as_f64().unwrap_or(0.0);
        println!(
            "{name:<12} {level:>5} {period:>9} {:>10} {:>8} {:>8} {:>9.1} {:>9.1} {:>9.1}",
            number(&layer["beats"]),
            number(&layer["overruns"]),
            number(&layer["skipped"]),
            us("p50"),
            us("p99"),
            us("max")
        );
    }
    let holding: Vec<String> = list(&status, "taps")
        .filter(|t| t["holds"] == true)
        .map(show_tap)
        .collect();
    if !holding.is_empty() {
        println!("\ntaps that hold:\n{}", holding.join("\n"));
    }
    let waiting = list(&status, "taps").filter(|t| t["joined"] == false);
    let waiting: Vec<String> = waiting
        .map(|t| {
            let at = t["at"].as_str().unwrap_or("its layer");
            format!("  {} > {} waits for {at}", text(&t["from"]), text(&t["to"]))
        })
        .collect();
    if !waiting.is_empty() {
        println!("\ntaps that wait:\n{}", waiting.join("\n"));
    }
    Ok(())
}

/// A count as text, so that it can be set to a width.
fn number(value: &Value) -> String {
    value.as_u64().map_or("-".into(), |n| n.to_string())
}

fn show_tap(tap: &Value) -> String {
    let remaining = tap["remaining_ms"].as_f64().unwrap_or(0.0);
    let (from, to, kind) = (text(&tap["from"]), text(&tap["to"]), text(&tap["kind"]));
    let what = if kind == "suppress" {
        "suppresses"
    } else {
        "inhibits"
    };
    format!(
        "  {from} {what} {to}, {remaining:.0} ms left; delivered {}, rejected {}",
        tap["delivered"], tap["rejected"]
    )
}

pub(crate) fn wires(creature: &str, as_json: bool) -> Done {
    let status = ask_status(creature)?;
    if as_json {
        println!("{}", json!({ "wires": status["wires"] }));
        return Ok(());
    }
    println!(
        "{:<24} {:<8} {:<6} {:>10} {:>9} {:>10}  value",
        "wire", "type", "unit", "messages", "Hz", "age ms"
    );
    for wire in list(&status, "wires") {
        let age = wire["age_ms"]
            .as_f64()
            .map_or("never".into(), |a| format!("{a:.0}"));
        println!(
            "{:<24} {:<8} {:<6} {:>10} {:>9.1} {age:>10}  {}",
            text(&wire["wire"]),
            text(&wire["type"]),
            text(&wire["unit"]),
            number(&wire["messages"]),
            wire["rate_hz"].as_f64().unwrap_or(0.0),
            short(&wire["value"]),
        );
    }
    Ok(())
}

/// A value as a person reads it: three decimals are a millimetre.
pub(crate) fn short(value: &Value) -> String {
    match value {
        Value::Null => "-".into(),
        Value::Number(n) => format!("{:.3}", n.as_f64().unwrap_or(0.0)),
        Value::Array(items) => format!("[{}]", items.iter().map(short).collect::<Vec<_>>().join(" ")),
        other => other.to_string(),
    }
}

pub(crate) fn events(creature: &str, as_json: bool) -> Done {
    let Reply::Events(events) = ask(creature, &Request::Events { after: 0 })? else {
        return Err("the daemon answered something else".into());
    };
    for event in events {
        if as_json {
            println!("{}", json!(event));
        } else {
            println!("[{:9.3}] {}", event.time_s, event.text);
        }
    }
    Ok(())
}

/// Asks for something to be done.
pub(crate) fn send(creature: &str, request: &Request) -> Done {
    ask(creature, request).map(drop)
}

pub(crate) fn order(creature: &str, as_json: bool, request: Request, said: &str) -> Done {
    send(creature, &request)?;
    if as_json {
        println!("{}", json!({ "done": said }));
    } else {
        println!("{creature}: {said}");
    }
    Ok(())
}
