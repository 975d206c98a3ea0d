//! The schema against the reader: the same keys, the same ranges; good files pass, bad ones do not.

use ipc::wiring::grammar::{self, Grammar, Value};
use ipc::wiring::schema::schema;
use ipc::wiring::{Rule, Source, check};
use serde_json::Value as Json;

use crate::golden::{files, folder};
use crate::kinds::Kinds;

/// What is wrong with `value` by the part of JSON Schema that ours uses; patterns are left to [`pattern`].
fn against(schema: &Json, value: &Json, root: &Json, path: &str, wrong: &mut Vec<String>) {
    if schema == &Json::Bool(true) {
        return;
    }
    let mut fail = |what: String| wrong.push(format!("{path}: {what}"));
    if schema == &Json::Bool(false) {
        return fail("nothing may stand here".into());
    }
    for key in schema.as_object().expect("a schema").keys() {
        let known = [
            "$schema",
            "$defs",
            "$ref",
            "title",
            "description",
            "default",
            "examples",
            "type",
            "properties",
            "required",
            "additionalProperties",
            "propertyNames",
            "items",
            "oneOf",
            "allOf",
            "if",
            "then",
            "const",
            "enum",
            "minimum",
            "maximum",
            "maxLength",
            "maxItems",
            "pattern",
            "not",
        ];
        assert!(known.contains(&key.as_str()), "this test does not know {key:?}");
    }
    let passes = |schema: &Json| {
        let mut wrong = Vec::new();
        against(schema, value, root, path, &mut wrong);
        wrong.is_empty()
    };
    if let Some(kind) = schema["type"].as_str() {
        let fits = match kind {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "boolean" => value.is_boolean(),
            "integer" => value.is_i64() || value.is_u64(),
            "number" => value.is_number(),
            other => panic!("unknown type {other}"),
        };
        if !fits {
            return fail(format!("{value} is no {kind}"));
        }
    }
    if schema.get("const").is_some_and(|c| c != value) {
        fail(format!("{value} is not {}", schema["const"]));
    }
    if schema["enum"].as_array().is_some_and(|e| !e.contains(value)) {
        fail(format!("{value} is none of {}", schema["enum"]));
    }
    if let (Some(low), Some(n)) = (schema["minimum"].as_f64(), value.as_f64())
        && n < low
    {
        fail(format!("{n} is below {low}"));
    }
    if let (Some(high), Some(n)) = (schema["maximum"].as_f64(), value.as_f64())
        && n > high
    {
        fail(format!("{n} is above {high}"));
    }
    if schema["not"].is_object() && passes(&schema["not"]) {
        fail("it passes what it must not".into());
    }
    if let Some(cases) = schema["oneOf"].as_array() {
        let n = cases.iter().filter(|c| passes(c)).count();
        if n != 1 {
            fail(format!("{n} of the cases fit"));
        }
    }
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.strip_prefix("#/$defs/").expect("a definition");
        against(&root["$defs"][name], value, root, path, wrong);
    }
    for part in schema["allOf"].as_array().into_iter().flatten() {
        against(part, value, root, path, wrong);
    }
    if schema["if"].is_object() && passes(&schema["if"]) {
        against(&schema["then"], value, root, path, wrong);
    }
    for (i, item) in value.as_array().into_iter().flatten().enumerate() {
        if schema["items"].is_object() {
            against(&schema["items"], item, root, &format!("{path}[{i}]"), wrong);
        }
    }
    if let Some(object) = value.as_object() {
        for name in schema["required"].as_array().into_iter().flatten() {
            if !object.contains_key(name.as_str().expect("a key")) {
                wrong.push(format!("{path}: {name} is missing"));
            }
        }
        for (key, value) in object {
            if schema["propertyNames"].is_object() {
                against(
                    &schema["propertyNames"],
                    &Json::from(key.as_str()),
                    root,
                    path,
                    wrong,
                );
            }
            let path = format!("{path}.{key}");
            if let Some(inner) = schema["properties"].get(key) {
                against(inner, value, root, &path, wrong);
            } else if let Some(others) = schema.get("additionalProperties") {
                against(others, value, root, &path, wrong);
            }
        }
    }
}

fn violations(text: &str) -> Vec<String> {
    let value: toml::Table = text.parse().expect("TOML");
    let value = serde_json::to_value(value).expect("JSON");
    let schema = schema(&Kinds);
    let mut wrong = Vec::new();
    against(&schema, &value, &schema, "file", &mut wrong);
    wrong
}

#[test]
fn good_files_pass_the_schema() {
    for path in files(&folder("good")) {
        let text = std::fs::read_to_string(&path).expect("text");
        let wrong = violations(&text);
        assert!(wrong.is_empty(), "{}: {wrong:#?}", path.display());
    }
}

#[test]
fn bad_files_that_a_schema_can_see_do_not_pass_it() {
    for name in [
        "unknown-keys-everywhere",
        "missing-keys",
        "missing-time-constant",
        "no-layer",
        "layer-as-table",
        "wrong-types",
        "tables-that-are-none",
        "unknown-words",
        "unknown-kinds",
        "reserved-name",
        "out-of-range",
        "bad-accounts",
        "exclusive-keys",
    ] {
        let path = folder("bad").join(name).with_extension("toml");
        let text = std::fs::read_to_string(path).expect("text");
        assert!(!violations(&text).is_empty(), "{name} passes the schema");
    }
}

/// The tables of the grammar, each with a file that holds one, up to where its keys stand. Which keys a body or a
/// module takes is known when its kind is.
fn tables() -> Vec<(&'static Grammar, &'static str)> {
    vec![
        (&grammar::FILE, ""),
        (&grammar::BODY, "[body]\nkind = \"cart\"\n"),
        (&grammar::LAYER, "[[layer]]\n"),
        (
            &grammar::MODULE,
            "[[layer]]\n[layer.modules.m]\nkind = \"wander\"\n",
        ),
        (&grammar::SUPPRESS, "[[layer]]\n[[layer.suppress]]\n"),
        (&grammar::INHIBIT, "[[layer]]\n[[layer.inhibit]]\n"),
        (&grammar::HALT, "[halt]\n"),
        (&grammar::OUTSIDERS, "[outsiders]\n"),
        (&grammar::EXECUTOR, "[executor]\n"),
    ]
}

#[test]
fn the_reader_takes_every_key_of_the_schema_and_no_other() {
    for (grammar, head) in tables() {
        let refused = |key: &str| {
            let source = Source::new("x.toml", format!("{head}{key} = 1979-05-27\n"));
            let refused = check::creature(&source, &Kinds).expect_err("a date is nothing");
            refused
                .diagnostics
                .iter()
                .any(|d| d.rule == Some(Rule::UnknownKey) && d.message.contains(&format!("{key:?}")))
        };
        for key in grammar
            .keys
            .iter()
            .filter(|k| k.name != "kind" || grammar.kinds.is_none())
        {
            assert!(!refused(key.name), "{:?} of {}", key.name, grammar.what);
        }
        assert!(refused("nonsense"), "{}", grammar.what);
    }
}

#[test]
fn ranges_of_the_schema_are_those_of_the_reader() {
    for (grammar, head) in tables() {
        for key in grammar.keys {
            let (low, high) = match key.takes {
                Value::Whole { low, high } => (low, high),
                _ => continue,
            };
            let refused = |n: i128| {
                let text = format!("{head}{} = {n}\n", key.name);
                let refused = check::creature(&Source::new("x.toml", text), &Kinds).expect_err("a part");
                refused
                    .diagnostics
                    .iter()
                    .any(|d| d.rule == Some(Rule::OutOfRange))
            };
            let (low, high) = (i128::from(low), i128::from(high));
            assert!(!refused(low) && !refused(high), "{:?} within", key.name);
            assert!(refused(low - 1) && refused(high + 1), "{:?} without", key.name);
        }
    }
}

#[test]
fn defaults_of_the_schema_are_those_of_the_reader() {
    let spare =
        "creature = \"c\"\n[body]\nkind = \"cart\"\n[[layer]]\nname = \"l\"\nlevel = 0\nperiod = \"1s\"\n";
    let mut full = String::from("creature = \"c\"\n");
    for (grammar, head) in tables() {
        if [&grammar::MODULE, &grammar::SUPPRESS, &grammar::INHIBIT]
            .iter()
            .any(|g| std::ptr::eq(*g, grammar))
        {
            continue;
        }
        full.push_str(head);
        if std::ptr::eq(grammar, &grammar::LAYER) {
            full.push_str("name = \"l\"\nlevel = 0\nperiod = \"1s\"\n");
        }
        // With wake = "sleep", its default, spin has no place.
        for key in grammar
            .keys
            .iter()
            .filter(|k| !k.default.is_empty() && k.name != "spin")
        {
            full.push_str(&format!("{} = {}\n", key.name, key.default));
        }
    }
    let creature = |text: &str| {
        let checked = check::creature(&Source::new("x.toml", text), &Kinds);
        format!("{:#?}", checked.unwrap_or_else(|e| panic!("{e}")))
    };
    assert_eq!(creature(spare), creature(&full));
}
