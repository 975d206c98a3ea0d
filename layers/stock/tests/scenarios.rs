//! Every stock kind has a scenario file, and every declaration says what a reader needs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use ipc::wiring::Catalog;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

/// The part of a kind's name before the dot: a family has one scenario file.
fn stem(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// Kinds of another name that share a family's file.
const SHARED: [(&str, &str); 1] = [("random-heading", "random")];

fn file_of(kind: &str) -> String {
    let shared = SHARED.iter().find(|(name, _)| *name == kind);
    shared.map_or(stem(kind), |(_, file)| file).to_string()
}

#[test]
fn every_kind_has_a_scenario_file_in_which_it_is_tried() {
    let mut missing = Vec::new();
    for kind in stock::modules() {
        let name = kind.declaration.name;
        let path = folder().join(file_of(name)).with_extension("toml");
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let tried = text
            .lines()
            .find(|l| l.contains(&format!("kind = \"{name}\"")) && !l.trim_start().starts_with('#'));
        // The module is tried if something is expected of one of its outputs.
        let expected = tried.and_then(|l| l.split(" = ").next()).is_some_and(|module| {
            let mut outputs = kind.declaration.outputs.iter();
            outputs.all(|port| text.contains(&format!("wire = \"{}.{}\"", module.trim(), port.name)))
        });
        if !expected {
            missing.push(format!("{name}: nothing is expected of it in {}", path.display()));
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn no_scenario_file_is_left_over() {
    let known: BTreeSet<String> = stock::modules().map(|k| file_of(k.declaration.name)).collect();
    for entry in std::fs::read_dir(folder()).expect("the folder is there") {
        let path = entry.expect("a file").path();
        let name = path.file_stem().expect("a name").to_string_lossy().to_string();
        assert!(known.contains(&name), "{} is about no stock kind", path.display());
    }
}

#[test]
fn every_declaration_is_complete() {
    let declared = stock::kinds().modules();
    assert_eq!(declared.len(), stock::modules().count());
    for d in declared {
        assert!(!d.about.is_empty() && !d.diagram.is_empty(), "{}", d.name);
        assert!(!d.outputs.is_empty(), "{} has no output", d.name);
        let abouts = d.inputs.iter().chain(d.outputs).map(|p| (p.name, p.about));
        for (name, about) in abouts.chain(d.parameters.iter().map(|p| (p.name, p.about))) {
            assert!(!name.is_empty() && !about.is_empty(), "{}: {name:?}", d.name);
        }
        assert!(d.about.len() <= 100, "{}: one line is enough", d.name);
    }
}
