//! Bad files and what is said of them: `bad/x.toml` is refused with the text of `bad/x.expected`.
//!
//! `BLESS=1 cargo test -p ipc --test wiring` writes the texts anew; read them before you keep them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use ipc::wiring::rule::{RULES, Rule};
use ipc::wiring::{Creature, Directory, Rejected, Source, check};

use crate::kinds::Kinds;

pub(crate) fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

/// The files of a folder that end in `.toml`, sorted.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut files: Vec<PathBuf> = entries
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

fn name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

fn source(path: &Path) -> Result<Source, Rejected> {
    let source = Source::from_bytes(name(path), std::fs::read(path).expect("the file can be read"))?;
    Ok(source.beside(path))
}

/// The creature that the manifests of the tests want to join.
pub(crate) fn host() -> Directory {
    let source = source(&folder("good/cart.toml")).expect("text");
    let creature = check::creature(&source, &Kinds).unwrap_or_else(|e| panic!("{e}"));
    Directory::of(&creature, "cart")
}

fn checked(path: &Path, host: Option<&Directory>) -> Result<Creature, Rejected> {
    let source = source(path)?;
    match host {
        None => check::creature(&source, &Kinds),
        Some(host) => check::manifest(&source, &Kinds, host),
    }
}

/// What is said of every bad file.
fn refusals() -> Vec<(PathBuf, Rejected)> {
    let host = host();
    let creatures = files(&folder("bad")).into_iter().map(|p| (p, None));
    let manifests = files(&folder("bad/manifests"))
        .into_iter()
        .map(|p| (p, Some(&host)));
    let refused = |(path, host): (PathBuf, Option<&Directory>)| {
        let rejected = checked(&path, host)
            .err()
            .unwrap_or_else(|| panic!("{} is not refused", path.display()));
        (path, rejected)
    };
    creatures.chain(manifests).map(refused).collect()
}

#[test]
fn bad_files_are_refused_with_exactly_these_words() {
    let bless = std::env::var_os("BLESS").is_some();
    let mut wrong = Vec::new();
    let refusals = refusals();
    assert!(refusals.len() >= 50, "{} bad files", refusals.len());
    for (path, rejected) in refusals {
        let golden = path.with_extension("expected");
        // Without the folder, so that it is the same everywhere.
        let own_folder = format!("{}/", path.parent().expect("a folder").display());
        let said = format!("{rejected}\n").replace(&own_folder, "");
        if bless {
            std::fs::write(&golden, &said).expect("the golden text can be written");
        } else if std::fs::read_to_string(&golden).unwrap_or_default() != said {
            wrong.push(format!("{} is refused with:\n{said}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_golden_text_belongs_to_a_bad_file() {
    for folder in [folder("bad"), folder("bad/manifests")] {
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            let lone =
                path.extension().is_some_and(|e| e == "expected") && !path.with_extension("toml").exists();
            assert!(!lone, "{} has no file", path.display());
        }
    }
}

#[test]
fn every_rule_has_a_bad_file() {
    let refusals = refusals();
    let found = refusals.iter().flat_map(|(_, r)| &r.diagnostics);
    let broken: BTreeSet<Rule> = found.filter_map(|d| d.rule).collect();
    let missing: Vec<&str> = RULES
        .iter()
        // Too large to lie in a folder: the next test makes them.
        .filter(|r| ![Rule::FileTooLong, Rule::TooManyLayers, Rule::TooManyWires].contains(r))
        .filter(|r| !broken.contains(r))
        .map(|r| r.code())
        .collect();
    assert!(missing.is_empty(), "no bad file breaks {missing:?}");
}

#[test]
fn files_beyond_the_bounds_are_refused() {
    let rules = |text: String| {
        let refused = check::creature(&Source::new("large.toml", text), &Kinds).expect_err("too large");
        refused.diagnostics.iter().map(|d| d.rule).collect::<Vec<_>>()
    };
    let long = "#".repeat((4 << 20) + 1);
    assert_eq!(rules(long), [Some(Rule::FileTooLong)]);
    let layer = |i: usize| format!("[[layer]]\nname = \"l{i}\"\nlevel = 0\nperiod = \"1s\"\n");
    let layers: String = (0..1_025).map(layer).collect();
    assert_eq!(
        rules(format!("creature = \"large\"\n{layers}")),
        [Some(Rule::TooManyLayers)]
    );
    let modules: String = (0..820)
        .map(|i| format!("p{i} = {{ kind = \"panel\" }}\n"))
        .collect();
    let text = format!("creature = \"large\"\n{}[layer.modules]\n{modules}", layer(0));
    assert_eq!(rules(text), [Some(Rule::TooManyWires)]);
}

#[test]
fn every_code_is_a_word_of_its_own() {
    let codes: BTreeSet<&str> = RULES.iter().map(|r| r.code()).collect();
    assert_eq!(codes.len(), RULES.len());
    for code in codes {
        assert!(code.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{code}");
    }
}

#[test]
fn every_error_has_a_code_a_place_and_help() {
    for (path, rejected) in refusals() {
        for located in rejected.located() {
            let path = path.display();
            assert!(located.rule.is_some(), "{path}: {} has no code", located.message);
            assert!(located.line > 0 && located.column > 0, "{path}: no place");
            assert!(
                !located.help.is_empty(),
                "{path}: {} has no help",
                located.message
            );
        }
    }
}

#[test]
fn good_files_are_sound() {
    let host = host();
    for path in files(&folder("good")) {
        let manifest = name(&path).starts_with("layer-");
        let checked = checked(&path, manifest.then_some(&host));
        assert!(checked.is_ok(), "{}", checked.expect_err("is wrong"));
    }
}

#[test]
fn control_characters_of_a_file_do_not_reach_the_terminal() {
    let text = "creature = \"\u{7f}x\"\n# \u{1b}[31m\nlayer = \"\\u001b[31m\" # \u{1b}[0m\n";
    let refused = check::creature(&Source::new("x.toml", text), &Kinds).expect_err("nonsense");
    let said = refused.to_string();
    assert!(!said.contains('\u{1b}') && !said.contains('\u{7f}'), "{said:?}");
}
