//! The kinds of module: a list by group, and each one explained with an example of its use.
//!
//! Must never say of a kind what its declaration doesn't: texts, ranges and the example all come from there.

use std::process::ExitCode;

use daemon::machine::kinds;
use ipc::wiring::Catalog;
use ipc::wiring::catalog::{Declaration, Port, RESET, Takes};
use ipc::wiring::diagnostic::one_of;
use serde_json::{Value, json};

use crate::example;

/// The group of the stock modules.
const STOCK: &str = "stock";

/// Kinds that go by one name, such as `hold` and `hold.bit`; a kind of a creature stands alone.
struct Family {
    group: &'static str,
    kinds: Vec<&'static Declaration>,
}

pub(crate) fn modules(name: Option<&str>, as_json: bool) -> ExitCode {
    let families = families(&kinds().modules());
    let every = || families.iter().flat_map(|f| &f.kinds).copied();
    let Some(name) = name else {
        show(&families, as_json);
        return ExitCode::SUCCESS;
    };
    if let Some(kind) = every().find(|d| d.name == name) {
        if as_json {
            println!("{}", json!({ "modules": [describe(kind)] }));
        } else {
            print!("{}", explained(kind));
        }
        return ExitCode::SUCCESS;
    }
    // A group, such as `allen`, or a family without a plain name, such as `split`.
    let part = |f: &Family| f.group == name || stem(f.kinds[0].name) == name;
    let (some, _): (Vec<_>, Vec<_>) = families.into_iter().partition(part);
    if !some.is_empty() {
        show(&some, as_json);
        return ExitCode::SUCCESS;
    }
    let known = kinds().modules();
    let message = format!("unknown kind of module {name:?}");
    let help = one_of("kind", name, known.iter().map(|d| d.name));
    if as_json {
        println!("{}", json!({ "error": message, "help": help }));
    }
    eprintln!("{message}; {help}");
    ExitCode::from(2)
}

/// The part of a kind's name before the dot.
fn stem(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// Families by group, the stock modules first, each group in order of name.
fn families(known: &[&'static Declaration]) -> Vec<Family> {
    let mut families: Vec<Family> = Vec::new();
    for &declaration in known {
        let group = group_of(declaration);
        let same = |f: &&mut Family| group == STOCK && stem(f.kinds[0].name) == stem(declaration.name);
        match families.iter_mut().find(same) {
            Some(family) => family.kinds.push(declaration),
            None => families.push(Family {
                group,
                kinds: vec![declaration],
            }),
        }
    }
    families.sort_by_key(|f| (f.group != STOCK, f.group, f.kinds[0].name));
    families
}

fn show(families: &[Family], as_json: bool) {
    if as_json {
        let kinds = families.iter().flat_map(|f| &f.kinds);
        let shown: Vec<_> = kinds.map(|d| describe(d)).collect();
        println!("{}", json!({ "modules": shown }));
    } else {
        print!("{}", listed(families));
    }
}

/// Every family on one page: each explained by its first kind.
pub(crate) fn markdown() -> String {
    let mut text = String::from(
        "# Modules\n\nWhat creature files can be wired from. A kind such as `hold.bit` is `hold` for messages of another \
         type. `subsumectl modules NAME` shows the same.\n",
    );
    let mut group = "";
    for family in families(&kinds().modules()) {
        if family.group != group {
            group = family.group;
            text += &format!("\n## {group}\n");
        }
        let first = family.kinds[0];
        let (name, others) = (first.name, others(&family));
        text += &format!(
            "\n### {name}{others}\n\n```text\n{}\n```\n",
            explained(first).trim_end()
        );
    }
    text
}

/// The list, with columns that line up.
fn listed(families: &[Family]) -> String {
    let wide = families.iter().map(|f| f.kinds[0].name.len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut group = "";
    for family in families {
        if family.group != group {
            let gap = if group.is_empty() { "" } else { "\n" };
            text += &format!("{gap}{}\n", family.group);
            group = family.group;
        }
        let first = family.kinds[0];
        text += &format!("  {:<wide$}  {}{}\n", first.name, first.about, others(family));
    }
    text
}

/// The other types of a family, in brackets.
fn others(family: &Family) -> String {
    let others: Vec<&str> = family.kinds[1..]
        .iter()
        .map(|d| &d.name[stem(d.name).len()..])
        .collect();
    if others.is_empty() {
        String::new()
    } else {
        format!(" (also {})", others.join(" "))
    }
}

fn group_of(d: &Declaration) -> &'static str {
    let ours = stock::modules().any(|k| k.declaration.name == d.name);
    if ours { STOCK } else { stem(d.name) }
}

fn describe(d: &Declaration) -> Value {
    let ports = |ports: &[Port]| ports.iter().map(port_json).collect::<Vec<_>>();
    let mut inputs = ports(d.inputs);
    inputs.push(port_json(&RESET));
    let parameters: Vec<Value> = d
        .parameters
        .iter()
        .map(|p| {
            let mut value = takes_json(&p.takes);
            value["name"] = p.name.into();
            value["unit"] = p.unit.into();
            value["about"] = p.about.into();
            value
        })
        .collect();
    json!({
        "name": d.name, "group": group_of(d), "about": d.about, "diagram": d.diagram,
        "inputs": inputs, "outputs": ports(d.outputs), "parameters": parameters,
        "example": example::of(d),
    })
}

fn port_json(p: &Port) -> Value {
    let [low, high] = [p.low, p.high].map(bound_json);
    json!({"name": p.name, "type": p.kind, "unit": p.unit, "low": low, "high": high, "about": p.about})
}

/// A bound, or nothing if any number will do.
fn bound_json(bound: f64) -> Value {
    if bound.abs() == f64::MAX {
        Value::Null
    } else {
        json!(bound)
    }
}

fn takes_json(takes: &Takes) -> Value {
    match takes {
        Takes::Number { low, high, default } => {
            json!({"type": "number", "default": default, "low": bound_json(*low), "high": bound_json(*high),
                   "required": default.is_none()})
        }
        Takes::Span { default } => {
            let shown = default.filter(|d| d.0 > 0).map(|d| d.to_string());
            json!({"type": "time", "default": shown, "required": default.is_none()})
        }
        Takes::Bit { default } => json!({"type": "bit", "default": default, "required": default.is_none()}),
        Takes::Word { words, default } => {
            json!({"type": "word", "words": words, "default": default, "required": default.is_none()})
        }
        Takes::Numbers {
            low,
            high,
            most,
            default,
        } => {
            json!({"type": "numbers", "default": default, "low": bound_json(*low), "high": bound_json(*high),
                   "most": most, "required": default.is_none()})
        }
        Takes::Spans { most, default } => {
            let shown = default.map(|d| d.iter().map(ToString::to_string).collect::<Vec<_>>());
            json!({"type": "times", "default": shown, "most": most, "required": default.is_none()})
        }
        Takes::File {
            bytes_max,
            instead_of,
            ..
        } => {
            json!({"type": "file", "default": null, "most_bytes": bytes_max, "instead_of": instead_of,
                   "required": false})
        }
    }
}

/// Everything about one kind.
fn explained(d: &Declaration) -> String {
    let inputs: Vec<&Port> = d.inputs.iter().chain([&RESET]).collect();
    let text = described(d, &inputs);
    let example = example::of(d).replace('\n', "\n  ");
    text + &format!(
        "\nexample, a creature file of its own\n\n  {}\n",
        example.trim_end()
    )
}

/// A kind of body in the same way: it has no reset line and no example, as a creature has one body.
pub(crate) fn body(d: &Declaration) -> String {
    described(d, &d.inputs.iter().collect::<Vec<_>>())
}

fn described(d: &Declaration, inputs: &[&Port]) -> String {
    let mut text = format!("{}: {}\n\n", d.name, d.about);
    for line in d.diagram.lines() {
        text += &format!("  {line}\n");
    }
    text += &table("inputs", inputs.iter().map(|p| port_row(p)));
    text += &table("outputs", d.outputs.iter().map(port_row));
    text += &table(
        "parameters",
        d.parameters.iter().map(|p| {
            let [default, range] = takes_text(&p.takes);
            [p.name, &default, p.unit, &range, p.about].map(String::from)
        }),
    );
    text
}

fn port_row(p: &Port) -> [String; 5] {
    let range = range(p.low, p.high);
    [p.name, p.kind.name(), p.unit, &range, p.about].map(String::from)
}

/// A table under a title, its columns as wide as they need to be; nothing if there are no rows.
fn table(title: &str, rows: impl Iterator<Item = [String; 5]>) -> String {
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let wide: [usize; 4] =
        std::array::from_fn(|column| rows.iter().map(|r| r[column].chars().count()).max().unwrap_or(0));
    let mut text = format!("\n{title}\n");
    for row in &rows {
        let mut line = String::from("  ");
        for (cell, wide) in row.iter().zip(wide).filter(|(_, wide)| *wide > 0) {
            line += &format!("{cell:<wide$}  ");
        }
        text += &format!("{line}{}\n", row[4]);
    }
    text
}

fn range(low: f64, high: f64) -> String {
    let [l, h] = [low, high].map(short);
    match (low > f64::MIN, high < f64::MAX) {
        (true, true) => format!("{l} to {h}"),
        (true, false) => format!("at least {l}"),
        (false, true) => format!("at most {h}"),
        (false, false) => String::new(),
    }
}

/// A number as a person would write it.
fn short(number: f64) -> String {
    const MANY: f64 = 1e6;
    let rounded = (number * 1e4).round() / 1e4;
    if number.abs() >= MANY {
        format!("{number:e}")
    } else {
        rounded.to_string()
    }
}

/// The default and the range of a parameter.
fn takes_text(takes: &Takes) -> [String; 2] {
    let default = |d: Option<String>| d.map_or("must be given".into(), |d| format!("default {d}"));
    let [shown, range] = match takes {
        Takes::Number { low, high, default } => [
            default.map(short),
            Some(format!("number {}", range(*low, *high)).trim_end().into()),
        ],
        Takes::Span { default } => {
            let none = |d: ipc::clock::Span| {
                if d.0 == 0 {
                    "none".into()
                } else {
                    format!("\"{d}\"")
                }
            };
            [default.map(none), Some("time".into())]
        }
        Takes::Bit { default } => [default.map(|b| b.to_string()), Some("true or false".into())],
        Takes::Word { words, default } => [default.map(|w| format!("{w:?}")), Some(words.join(", "))],
        Takes::Numbers {
            low,
            high,
            most,
            default,
        } => {
            let range = format!("up to {most} numbers, {}", range(*low, *high));
            let list =
                |n: &[f64]| format!("[{}]", n.iter().map(|n| short(*n)).collect::<Vec<_>>().join(", "));
            [default.map(list), Some(range.trim_end_matches([',', ' ']).into())]
        }
        Takes::Spans { most, default } => {
            let shown =
                default.map(|d| format!("{:?}", d.iter().map(ToString::to_string).collect::<Vec<_>>()));
            [shown, Some(format!("up to {most} times"))]
        }
        Takes::File { instead_of, .. } => {
            let range = match instead_of {
                [] => "path of a file".into(),
                others => format!("path of a file, instead of {}", others.join(" and ")),
            };
            [Some("none".into()), Some(range)]
        }
    };
    [default(shown), range.unwrap_or_default()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_listed_once_and_explained_whole() {
        let known = kinds().modules();
        let families = families(&known);
        let mut listed: Vec<&str> = families.iter().flat_map(|f| &f.kinds).map(|d| d.name).collect();
        let mut names: Vec<&str> = known.iter().map(|d| d.name).collect();
        listed.sort_unstable();
        names.sort_unstable();
        assert_eq!(listed, names);
        for d in known {
            let text = explained(d);
            let parts = d.parameters.iter().map(|p| p.about);
            for part in parts.chain(d.inputs.iter().chain(d.outputs).map(|p| p.about)) {
                assert!(text.contains(part), "{}: {part}", d.name);
            }
            assert!(text.contains("reset"), "{}", d.name);
        }
    }

    #[test]
    fn the_stock_modules_come_first_and_columns_line_up() {
        let text = listed(&families(&kinds().modules()));
        assert!(text.starts_with("stock\n"), "{text}");
        assert!(text.find("\nallen\n") > text.find("  threshold"), "{text}");
        let column = |name: &str, about: &str| {
            let line = text
                .lines()
                .find(|l| l.trim_start().starts_with(name))
                .expect("listed");
            line.find(about).expect("its line says what it does")
        };
        assert_eq!(
            column("sum ", "adds two messages"),
            column("threshold ", "true from when")
        );
    }
}
