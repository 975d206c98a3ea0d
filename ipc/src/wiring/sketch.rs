//! A sketch: what a file names, sound or not, so that a picture can show what is wrong with it.
//!
//! Must never be run, nor decide what is an error: the checker's findings are handed in with their places.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::creature::{How, PortName};
use super::diagnostic::{Diagnostic, Findings, Rejected, Source};
use super::document::{self as doc};
use crate::clock::Span;

/// The parts of a file as far as they can be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// The creature's name; empty if there is none.
    pub name: String,
    /// Its layers, in the order of the file.
    pub layers: Vec<SketchLayer>,
    /// What is wrong with parts that stand nowhere in a picture.
    pub faults: Vec<String>,
}

/// A layer of a sketch.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchLayer {
    /// Its name; empty if there is none.
    pub name: String,
    /// Its level; 0 if it cannot be read.
    pub level: u8,
    /// Names and kinds of its modules.
    pub modules: Vec<Marked<(String, String)>>,
    /// Its wires, one for each reader.
    pub wires: Vec<Marked<(PortName, PortName)>>,
    /// Its taps.
    pub taps: Vec<Marked<SketchTap>>,
}

/// A tap of a sketch.
#[derive(Clone, Debug, PartialEq)]
pub struct SketchTap {
    /// Which way it acts.
    pub how: How,
    /// Where its messages come from.
    pub from: PortName,
    /// Where it acts.
    pub to: PortName,
    /// Its time constant, if it can be read.
    pub time_constant: Option<Span>,
}

/// A part, and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Marked<T> {
    /// The part.
    pub part: T,
    /// What the checker says of it.
    pub fault: Option<String>,
}

/// Sketches `source`, of which the checker said `rejected` (nothing, if it is sound).
pub fn sketch(source: &Source, rejected: Option<&Rejected>) -> Sketch {
    let diagnostics = rejected.map_or(&[][..], |r| &r.diagnostics);
    let mut marker = Marker {
        diagnostics,
        placed: vec![false; diagnostics.len()],
    };
    let mut sketch = Sketch::default();
    if let Some(root) = doc::parse(source, &mut Findings::default()) {
        let root = root.get_ref();
        sketch.name = get(root, "creature").and_then(text).unwrap_or_default();
        let layers = get(root, "layer").map(items).unwrap_or_default();
        sketch.layers = layers.into_iter().filter_map(|v| layer(v, &mut marker)).collect();
    }
    for (diagnostic, placed) in diagnostics.iter().zip(marker.placed) {
        if !placed {
            let file = diagnostic.within.as_deref().unwrap_or(source);
            let (line, _) = file.place(diagnostic.at.start);
            sketch
                .faults
                .push(format!("{}:{line}: {}", file.name, say(diagnostic)));
        }
    }
    sketch
}

/// Finds what was said about a place in the file.
struct Marker<'d> {
    diagnostics: &'d [Diagnostic],
    placed: Vec<bool>,
}

impl Marker<'_> {
    fn fault(&mut self, places: &[Range<usize>]) -> Option<String> {
        let mut said: Vec<String> = Vec::new();
        for (diagnostic, placed) in self.diagnostics.iter().zip(&mut self.placed) {
            let at = diagnostic.here();
            if at.start < at.end && places.iter().any(|p| p.start < at.end && at.start < p.end) {
                *placed = true;
                said.push(say(diagnostic));
            }
        }
        (!said.is_empty()).then(|| said.join("\n"))
    }
}

fn say(diagnostic: &Diagnostic) -> String {
    if diagnostic.help.is_empty() {
        return diagnostic.message.clone();
    }
    format!("{}: {}", diagnostic.message, diagnostic.help)
}

type Value<'s> = Spanned<DeValue<'s>>;

fn get<'t, 's>(table: &'t DeTable<'s>, key: &str) -> Option<&'t Value<'s>> {
    table.iter().find(|(k, _)| k.get_ref() == key).map(|(_, v)| v)
}

fn text(value: &Value<'_>) -> Option<String> {
    match value.get_ref() {
        DeValue::String(s) => Some(s.to_string()),
        _ => None,
    }
}

fn items<'t, 's>(value: &'t Value<'s>) -> Vec<&'t Value<'s>> {
    match value.get_ref() {
        DeValue::Array(items) => items.iter().collect(),
        _ => Vec::new(),
    }
}

fn table<'t, 's>(value: &'t Value<'s>) -> Option<&'t DeTable<'s>> {
    match value.get_ref() {
        DeValue::Table(table) => Some(table),
        _ => None,
    }
}

fn layer(value: &Value<'_>, marker: &mut Marker<'_>) -> Option<SketchLayer> {
    let keys = table(value)?;
    let level = get(keys, "level").and_then(|v| match v.get_ref() {
        DeValue::Integer(n) => u8::from_str_radix(n.as_str(), n.radix()).ok(),
        _ => None,
    });
    let modules = get(keys, "modules").and_then(table);
    let modules = modules.into_iter().flat_map(|t| t.iter()).map(|(key, value)| {
        let kind = table(value).and_then(|t| get(t, "kind")).and_then(text);
        Marked {
            part: (key.get_ref().to_string(), kind.unwrap_or_default()),
            fault: marker.fault(&[key.span(), value.span()]),
        }
    });
    let modules = modules.collect();
    let mut wires = Vec::new();
    for item in get(keys, "wires").map(items).unwrap_or_default() {
        wires.extend(wire(item, marker));
    }
    let mut taps = Vec::new();
    for (key, how, port) in [
        ("suppress", How::Suppress, "input"),
        ("inhibit", How::Inhibit, "output"),
    ] {
        for item in get(keys, key).map(items).unwrap_or_default() {
            taps.extend(tap(item, how, port, marker));
        }
    }
    Some(SketchLayer {
        name: get(keys, "name").and_then(text).unwrap_or_default(),
        level: level.unwrap_or(0),
        modules,
        wires,
        taps,
    })
}

fn wire(value: &Value<'_>, marker: &mut Marker<'_>) -> Vec<Marked<(PortName, PortName)>> {
    let Some(given) = text(value) else {
        return Vec::new();
    };
    let Some((from, to)) = given.split_once("->") else {
        return Vec::new();
    };
    let place = |part: &str| {
        let start = part.as_ptr() as usize - given.as_ptr() as usize;
        let whole = value.span();
        // One byte for the opening quote; with escapes in the text the place of the whole has to do.
        if whole.len() == given.len() + 2 {
            let from = whole.start + 1 + start;
            from..from + part.len()
        } else {
            whole
        }
    };
    let mut wires = Vec::new();
    for to in to.split(',') {
        let (Some(source), Some(sink)) = (port(from), port(to)) else {
            continue;
        };
        let fault = marker.fault(&[place(from), place(to)]);
        wires.push(Marked {
            part: (source, sink),
            fault,
        });
    }
    wires
}

fn tap(value: &Value<'_>, how: How, key: &str, marker: &mut Marker<'_>) -> Option<Marked<SketchTap>> {
    let keys = table(value)?;
    let end = |key: &str| get(keys, key).and_then(text).and_then(|t| port(&t));
    let (from, to) = (end("from")?, end(key)?);
    let time_constant = get(keys, "time_constant").and_then(text);
    let time_constant = time_constant.and_then(|t| Span::parse(&t).ok());
    let part = SketchTap {
        how,
        from,
        to,
        time_constant: time_constant.filter(|t| *t > Span::ZERO),
    };
    Some(Marked {
        part,
        fault: marker.fault(&[value.span()]),
    })
}

fn port(name: &str) -> Option<PortName> {
    let (module, port) = name.trim().split_once('.')?;
    let sound = |s: &str| !s.is_empty() && !s.chars().any(|c| c.is_control() || c == '.');
    (sound(module) && sound(port)).then(|| PortName {
        module: module.into(),
        port: port.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wiring::{Catalog, Declaration, check};

    const FILE: &str = r#"
creature = "x"
[[layer]]
name = "low"
level = 0
period = "10ms"
wires = ["a.out -> b.in, c.in", "nothing"]
inhibit = [{ from = "a.out", output = "b.out" }]
[layer.modules]
a = { kind = "some" }
"#;

    /// Knows no kind of module at all.
    struct Nothing;

    impl Catalog for Nothing {
        fn modules(&self) -> Vec<&'static Declaration> {
            Vec::new()
        }
        fn bodies(&self) -> Vec<&'static Declaration> {
            Vec::new()
        }
    }

    #[test]
    fn every_readable_part_is_there() {
        let sketch = sketch(&Source::new("x.toml", FILE), None);
        assert_eq!(sketch.name, "x");
        let layer = &sketch.layers[0];
        assert_eq!((layer.level, layer.modules.len()), (0, 1));
        let wires: Vec<String> = layer
            .wires
            .iter()
            .map(|w| format!("{}>{}", w.part.0, w.part.1))
            .collect();
        assert_eq!(wires, ["a.out>b.in", "a.out>c.in"]);
        assert_eq!(layer.taps[0].part.time_constant, None);
    }

    #[test]
    fn faults_stand_where_the_checker_found_them() {
        let source = Source::new("x.toml", FILE);
        let rejected = check::creature(&source, &Nothing).expect_err("it has errors");
        let sketch = sketch(&source, Some(&rejected));
        let layer = &sketch.layers[0];
        let unknown = layer.modules[0].fault.as_deref().expect("an unknown kind");
        assert!(unknown.contains("some"), "{unknown}");
        let tap = layer.taps[0].fault.as_deref().expect("no time constant");
        assert!(tap.contains("time_constant"), "{tap}");
        assert!(layer.wires.iter().all(|w| w.part.0.module == "a"));
        let elsewhere = sketch.faults.join("\n");
        assert!(
            elsewhere.contains("x.toml:7: "),
            "the wire without an arrow: {elsewhere}"
        );
    }
}
