//! The schema: what editors need to help with creature files (JSON Schema, draft 2020-12).
//!
//! Must never know a key of its own: it is the [`grammar`] and the catalogue, in other words.

use serde_json::{Map, Value as Json, json};

use super::catalog::{Catalog, Declaration, Parameter, Takes};
use super::grammar::{self, Grammar, Key, Kinds, Value};
use super::read::port::NAME_MAX;

/// The schema of creature files and manifests made of the kinds of `catalog`.
pub fn schema(catalog: &dyn Catalog) -> Json {
    let mut root = table(&grammar::FILE, catalog);
    let object = root.as_object_mut().expect("a table's schema is an object");
    object.insert(
        "$schema".into(),
        "https://json-schema.org/draft/2020-12/schema".into(),
    );
    object.insert("title".into(), "creature file".into());
    // That there is a layer at all is a rule of the checker; editors get to know it here.
    object.insert("required".into(), json!(["creature", "layer"]));
    let name = format!("[A-Za-z0-9_-]{{1,{NAME_MAX}}}");
    let port = format!("{name}\\.{name}");
    let number = "\\+?([0-9]+\\.?[0-9]*|\\.[0-9]+)";
    let time = format!("{number} *(ns|us|ms|s|min)$");
    object.insert(
        "$defs".into(),
        json!({
            "name": {"type": "string", "pattern": format!("^{name}$")},
            "port": {"type": "string", "pattern": format!("^ *{port} *$")},
            "wire": {"type": "string", "pattern": format!("^ *{port} *->( *{port} *,)* *{port} *$")},
            "time": {"type": "string", "pattern": format!("^{time}"), "examples": ["20ms", "1.5s", "50us"]},
            "positive": {
                "type": "string", "pattern": format!("^(?=.*[1-9]){time}"), "examples": ["20ms", "1.5s", "50us"],
            },
            "account": {
                "oneOf": [
                    {"type": "string", "maxLength": 32},
                    {"type": "integer", "minimum": 0, "maximum": u32::MAX - 1},
                ],
            },
        }),
    );
    root
}

fn table(grammar: &Grammar, catalog: &dyn Catalog) -> Json {
    let mut properties = Map::new();
    for key in grammar.keys {
        properties.insert(key.name.into(), of_key(key, catalog));
    }
    let required: Vec<&str> = grammar.keys.iter().filter(|k| k.needed).map(|k| k.name).collect();
    let mut schema = json!({
        "type": "object",
        "description": grammar.about,
        "properties": properties,
        "required": required,
    });
    let kinds = match grammar.kinds {
        None => {
            schema["additionalProperties"] = false.into();
            return schema;
        }
        Some(Kinds::Modules) => catalog.modules(),
        Some(Kinds::Bodies) => catalog.bodies(),
    };
    // Each kind takes the table's own keys and its parameters, and no others.
    let cases: Vec<Json> = kinds.iter().map(|d| of_kind(d, grammar)).collect();
    if !cases.is_empty() {
        schema["allOf"] = cases.into();
    }
    schema
}

fn of_key(key: &Key, catalog: &dyn Catalog) -> Json {
    let mut schema = of_value(&key.takes, catalog);
    schema["description"] = key.about.into();
    if !key.default.is_empty() {
        let default = serde_json::from_str::<Json>(key.default);
        schema["default"] = default.expect("a default stands as in a file");
    }
    schema
}

fn of_value(value: &Value, catalog: &dyn Catalog) -> Json {
    let list = |of: &str| json!({"type": "array", "items": {"$ref": format!("#/$defs/{of}")}});
    let one_of = |kinds: Vec<&'static Declaration>| {
        let kind = |d: &&Declaration| json!({"const": d.name, "description": d.about});
        json!({"oneOf": kinds.iter().map(kind).collect::<Vec<_>>()})
    };
    match *value {
        Value::Path => json!({"type": "string", "pattern": "^/"}),
        Value::Name => json!({"$ref": "#/$defs/name"}),
        Value::ModuleKind => one_of(catalog.modules()),
        Value::BodyKind => one_of(catalog.bodies()),
        Value::Whole { low, high } => json!({"type": "integer", "minimum": low, "maximum": high}),
        Value::Number { low, high } => number(low, high),
        Value::Time { positive } => {
            json!({"$ref": if positive { "#/$defs/positive" } else { "#/$defs/time" }})
        }
        Value::Bit => json!({"type": "boolean"}),
        Value::Word(words) => json!({"enum": words}),
        Value::Port => json!({"$ref": "#/$defs/port"}),
        Value::Ports => list("port"),
        Value::PortsOrAll => json!({"oneOf": [{"const": "*"}, list("port")]}),
        Value::Wires => list("wire"),
        Value::Accounts => list("account"),
        Value::Tables(grammar) => json!({"type": "array", "items": table(grammar, catalog)}),
        Value::Table(grammar) => table(grammar, catalog),
        Value::Named(grammar) => json!({
            "type": "object",
            "propertyNames": {"$ref": "#/$defs/name", "not": {"const": super::BODY}},
            "additionalProperties": table(grammar, catalog),
        }),
    }
}

fn number(low: f64, high: f64) -> Json {
    let mut schema = json!({"type": "number"});
    if low > f64::MIN {
        schema["minimum"] = low.into();
    }
    if high < f64::MAX {
        schema["maximum"] = high.into();
    }
    schema
}

fn of_kind(declaration: &Declaration, grammar: &Grammar) -> Json {
    let mut properties = Map::new();
    for key in grammar.keys {
        properties.insert(key.name.into(), true.into());
    }
    for parameter in declaration.parameters {
        properties.insert(parameter.name.into(), of_parameter(parameter));
    }
    let needed = declaration
        .parameters
        .iter()
        .filter(|p| p.takes.default().is_none());
    let required: Vec<&str> = needed.map(|p| p.name).collect();
    let mut then = json!({
        "description": declaration.about,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    let apart: Vec<Json> = declaration.parameters.iter().flat_map(not_together).collect();
    if !apart.is_empty() {
        then["allOf"] = apart.into();
    }
    json!({
        "if": {"properties": {"kind": {"const": declaration.name}}, "required": ["kind"]},
        "then": then,
    })
}

/// That a parameter does not stand beside those that it is given instead of.
fn not_together(parameter: &'static Parameter) -> impl Iterator<Item = Json> {
    let others = match parameter.takes {
        Takes::File { instead_of, .. } => instead_of,
        _ => &[],
    };
    others
        .iter()
        .map(|other| json!({"not": {"required": [parameter.name, other]}}))
}

fn of_parameter(parameter: &Parameter) -> Json {
    let (mut schema, default) = match parameter.takes {
        Takes::Number { low, high, default } => (number(low, high), default.map(Json::from)),
        Takes::Span { default } => (
            json!({"$ref": "#/$defs/positive"}),
            // Zero, which nobody can give, stands for none.
            default
                .filter(|d| *d > crate::clock::Span::ZERO)
                .map(|d| d.to_string().into()),
        ),
        Takes::Bit { default } => (json!({"type": "boolean"}), default.map(Json::from)),
        Takes::Word { words, default } => (json!({"enum": words}), default.map(Json::from)),
        Takes::Numbers {
            low,
            high,
            most,
            default,
        } => (
            json!({"type": "array", "items": number(low, high), "maxItems": most}),
            default.map(Json::from),
        ),
        Takes::Spans { most, default } => {
            let spell =
                |spans: &[crate::clock::Span]| spans.iter().map(|s| s.to_string()).collect::<Vec<_>>();
            (
                json!({"type": "array", "items": {"$ref": "#/$defs/time"}, "maxItems": most}),
                default.map(|d| spell(d).into()),
            )
        }
        Takes::File { .. } => (json!({"type": "string"}), None),
    };
    let unit = match parameter.unit {
        "" | "1" => String::new(),
        unit => format!(", in {unit}"),
    };
    schema["description"] = format!("{}{unit}", parameter.about).into();
    if let Some(default) = default {
        schema["default"] = default;
    }
    schema
}
