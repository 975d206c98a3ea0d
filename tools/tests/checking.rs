//! `subsumectl check` and `schema`, as scripts and editors use them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the workspace")
        .into()
}

fn subsumectl(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_subsumectl"));
    command.current_dir(root()).args(args).env_remove("NO_COLOR");
    command.output().expect("subsumectl runs")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const BAD: [&str; 2] = [
    "ipc/tests/bad/duplicate-layer.toml",
    "ipc/tests/bad/no-layer.toml",
];

#[test]
fn all_errors_of_all_files_are_shown_in_one_go() {
    let output = subsumectl(&["check", BAD[0], "layers/allen/allen.toml", "nowhere.toml", BAD[1]]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("error[duplicate-layer]") && said.contains("error[no-layer]"),
        "{said}"
    );
    assert!(said.contains("nowhere.toml: cannot be read"), "{said}");
    let sound = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(sound.contains("allen is sound"), "{sound}");
}

#[test]
fn a_manifest_is_checked_against_the_creature_beside_it_or_the_one_named() {
    for args in [
        &["check", "layers/allen/wander.toml"][..],
        &["check", "--manifest", "layers/allen/wander.toml"],
        &[
            "check",
            "--in",
            "layers/allen/allen.toml",
            "layers/allen/wander.toml",
        ],
    ] {
        let output = subsumectl(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(
            said.contains("layer wander is sound") && said.contains("may join allen"),
            "{said}"
        );
    }
    let lost = subsumectl(&["check", "--manifest", BAD[1]]);
    assert_eq!(lost.status.code(), Some(2));
    assert!(stderr(&lost).contains("--in CREATURE.toml"), "{}", stderr(&lost));
}

#[test]
fn errors_for_programs_carry_code_and_place() {
    let output = subsumectl(&["--json", "check", BAD[0], "nowhere.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stderr(&output), "");
    let errors: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let errors = errors["errors"].as_array().expect("a list");
    let first = errors.iter().find(|e| e["rule"] == "duplicate-layer");
    let first = first.expect("the rule that is broken");
    assert_eq!((&first["line"], &first["column"]), (&12.into(), &8.into()));
    assert_eq!(first["also"], serde_json::json!([7, 8]));
    assert_eq!(errors.last().expect("one for each file")["file"], "nowhere.toml");
}

#[test]
fn colours_come_when_asked_for_and_change_no_word() {
    let plain = stderr(&subsumectl(&["check", BAD[0]]));
    let never = stderr(&subsumectl(&["check", "--color", "never", BAD[0]]));
    let always = stderr(&subsumectl(&["check", "--color", "always", BAD[0]]));
    assert!(!plain.contains('\u{1b}'), "{plain}");
    assert_eq!(plain, never);
    assert!(always.contains("\u{1b}[1m"), "{always}");
    assert_eq!(anstream::adapter::strip_str(&always).to_string(), plain);
}

#[test]
fn the_schema_knows_every_kind_of_module() {
    let output = subsumectl(&["schema"]);
    assert_eq!(output.status.code(), Some(0));
    let schema: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let module = &schema["properties"]["layer"]["items"]["properties"]["modules"]["additionalProperties"];
    let kinds = module["allOf"].as_array().expect("a case for each kind");
    let known = subsumectl(&["--json", "modules"]);
    let known: Value = serde_json::from_slice(&known.stdout).expect("JSON");
    assert_eq!(kinds.len(), known["modules"].as_array().expect("a list").len());
}
