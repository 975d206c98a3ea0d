//! The reference, as Markdown: creature files, kinds of module, command lines, made from what reads them.
//!
//! Must never describe a key, a kind or an option by hand.

use std::fmt::Write as _;
use std::path::Path;

use clap::{Command, ValueEnum};
use ipc::wiring::Catalog;
use ipc::wiring::grammar::{self, Grammar, Key, Kinds, Value};
use ipc::wiring::rule::RULES;

use crate::manual::Program;
use crate::modules;

/// Writes `creature-file.md`, `modules.md` and `commands.md` into `folder`.
pub(crate) fn write(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, text) in pages() {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// Every page with its file's name.
pub(crate) fn pages() -> [(&'static str, String); 3] {
    [
        ("creature-file.md", creature_file()),
        ("modules.md", modules::markdown()),
        ("commands.md", commands()),
    ]
}

fn creature_file() -> String {
    let mut out = String::from(
        "# The creature file\n\nTOML; unknown keys are refused. Manifests of layers have the same grammar. \
         `subsumectl check FILE` says everything that is wrong in one go, `subsumectl schema` tells an editor.\n",
    );
    let mut waiting = vec![&grammar::FILE];
    let mut done: Vec<&str> = Vec::new();
    while let Some(table) = waiting.pop() {
        if done.contains(&table.what) {
            continue;
        }
        done.push(table.what);
        section(&mut out, table);
        waiting.extend(table.keys.iter().rev().filter_map(|k| below(k.takes)));
    }
    out.push_str("\n## Kinds of body\n");
    for kind in daemon::machine::kinds().bodies() {
        let _ = write!(
            out,
            "\n### `{}`\n\n```text\n{}\n```\n",
            kind.name,
            modules::body(kind).trim_end()
        );
    }
    out.push_str("\n## What is checked\n\n| code | rule |\n|---|---|\n");
    for rule in RULES {
        let _ = writeln!(out, "| `{}` | {} |", rule.code(), cell(rule.about()));
    }
    out
}

fn below(value: Value) -> Option<&'static Grammar> {
    match value {
        Value::Tables(table) | Value::Table(table) | Value::Named(table) => Some(table),
        _ => None,
    }
}

fn section(out: &mut String, table: &Grammar) {
    let title = table.what.trim_start_matches("this ").trim_start_matches("the ");
    let _ = write!(out, "\n## `{title}`\n\n{}.", table.about);
    match table.kinds {
        Some(Kinds::Modules) => {
            out.push_str(" Beside these keys it takes the parameters of its kind: [modules](modules.md).")
        }
        Some(Kinds::Bodies) => {
            out.push_str(" Beside these keys it takes the parameters of its [kind](#kinds-of-body).")
        }
        None => {}
    }
    out.push_str("\n\n| key | takes | default | |\n|---|---|---|---|\n");
    for key in table.keys {
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} |",
            key.name,
            cell(&takes(key)),
            default(key),
            cell(key.about)
        );
    }
}

fn default(key: &Key) -> String {
    match (key.needed, key.default) {
        (true, _) => "needed".into(),
        (false, "") => "–".into(),
        (false, default) => format!("`{default}`"),
    }
}

fn takes(key: &Key) -> String {
    match key.takes {
        Value::Name => "a name".into(),
        Value::ModuleKind => "a kind of module".into(),
        Value::BodyKind => "a kind of body".into(),
        Value::Whole { low, high } if high >= i64::MAX as u64 => format!("a whole number from {low}"),
        Value::Whole { low, high } => format!("a whole number, {low} to {high}"),
        Value::Number { low, high } => format!("a number, {low} to {high}"),
        Value::Time { positive: true } => "a time such as `\"20ms\"`".into(),
        Value::Time { positive: false } => "a time such as `\"0ms\"`".into(),
        Value::Bit => "`true` or `false`".into(),
        Value::Word(words) => words
            .iter()
            .map(|w| format!("`\"{w}\"`"))
            .collect::<Vec<_>>()
            .join(", "),
        Value::Path => "an absolute path".into(),
        Value::Port => "a port, `\"module.port\"`".into(),
        Value::Ports => "a list of ports".into(),
        Value::PortsOrAll => "a list of ports, or `\"*\"`".into(),
        Value::Wires => "a list of wires, `\"module.output -> module.input\"`".into(),
        Value::Accounts => "a list of names or numbers".into(),
        Value::Tables(_) => "tables, `[[...]]`".into(),
        Value::Table(_) => "a table".into(),
        Value::Named(_) => "tables by name".into(),
    }
}

/// As it may stand in a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn commands() -> String {
    let mut out = String::from("# Commands\n");
    for program in Program::value_variants() {
        let mut command = program.command().term_width(100);
        command.build();
        command_section(&mut out, &command, 2);
    }
    out
}

fn command_section(out: &mut String, command: &Command, depth: usize) {
    let name = command.get_bin_name().unwrap_or(command.get_name()).to_string();
    let help = command.clone().render_long_help().to_string();
    let help: Vec<&str> = help.lines().map(str::trim_end).collect();
    let _ = write!(
        out,
        "\n{} {name}\n\n```text\n{}\n```\n",
        "#".repeat(depth),
        help.join("\n").trim()
    );
    for one in command
        .get_subcommands()
        .filter(|c| c.get_name() != "help" && !c.is_hide_set())
    {
        command_section(out, one, (depth + 1).min(4));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `BLESS=1` writes the pages anew.
    #[test]
    fn the_reference_in_the_book_is_that_of_this_build() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/reference"));
        if std::env::var_os("BLESS").is_some() {
            write(folder).unwrap();
        }
        for (name, text) in pages() {
            let kept = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
            let differs = kept.lines().zip(text.lines()).position(|(a, b)| a != b);
            assert!(
                kept == text,
                "{name} differs from line {:?} on: `subsumectl reference docs/src/reference` writes it anew",
                differs.map(|line| line + 1)
            );
        }
    }

    #[test]
    fn every_table_and_every_rule_is_in_it() {
        let page = creature_file();
        for heading in [
            "## `file`",
            "## `[body]`",
            "## `[[layer]]`",
            "## `[halt]`",
            "## `[outsiders]`",
        ] {
            assert!(page.contains(heading), "{heading}");
        }
        for rule in RULES {
            assert!(page.contains(&format!("| `{}` |", rule.code())));
        }
    }
}
