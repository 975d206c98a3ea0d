//! What `subsumectl new` writes is sound, passes its scenarios and, as to the layer, builds.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of this test's own, removed when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(what: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("subsumectl-{what}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn subsumectl(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_subsumectl"));
    command.current_dir(folder).args(args);
    command.output().expect("subsumectl runs")
}

fn text(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

#[track_caller]
fn done(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", text(output));
    text(output)
}

#[track_caller]
fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", text(output));
    text(output)
}

#[test]
fn a_new_creature_is_sound_and_passes_its_scenario() {
    let folder = Folder::new("creature");
    done(&subsumectl(&folder.0, &["new", "creature", "mine"]));
    let said = done(&subsumectl(&folder.0, &["check", "mine/mine.toml"]));
    assert!(said.contains("mine is sound (2 layers, 2 modules)"), "{said}");
    done(&subsumectl(&folder.0, &["test", "mine/scenarios"]));
    let again = refused(&subsumectl(&folder.0, &["new", "creature", "mine"]));
    assert!(again.contains("there already"), "{again}");
    refused(&subsumectl(&folder.0, &["new", "creature", "My Creature"]));
    refused(&subsumectl(&folder.0, &["new", "creature", "../mine"]));
    refused(&subsumectl(&folder.0, &["new", "layer", "body"]));
    // A layer for it, from here.
    done(&subsumectl(
        &folder.0,
        &["new", "layer", "lead", "--in", "mine/mine.toml"],
    ));
    let manifest = std::fs::read_to_string(folder.0.join("lead/lead.toml")).expect("a manifest");
    assert!(
        manifest.contains("creature = \"mine\"") && manifest.contains("input = \"steer.in\""),
        "{manifest}"
    );
    // Its kind is its own: all else about it is sound.
    let said = refused(&subsumectl(
        &folder.0,
        &["check", "--in", "mine/mine.toml", "lead/lead.toml"],
    ));
    assert!(
        said.contains("unknown kind of module \"lead.sway\"") && said.contains("lead.toml: 1 error"),
        "{said}"
    );
}

/// The one costly test here: it compiles the new layer, in the folder where everything else was compiled.
#[test]
fn a_new_layer_builds_and_passes_its_scenario() {
    let folder = Folder::new("layer");
    done(&subsumectl(&folder.0, &["new", "layer", "sway-level"]));
    let layer = folder.0.join("sway-level");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the workspace");
    // The versions that are known to be there without a network.
    std::fs::copy(root.join("Cargo.lock"), layer.join("Cargo.lock")).expect("the lock file");
    let target = Path::new(env!("CARGO_BIN_EXE_subsumectl"))
        .parent()
        .and_then(Path::parent)
        .expect("the target folder");
    let built = Command::new(env!("CARGO"))
        .current_dir(&layer)
        .env("CARGO_TARGET_DIR", target)
        .args(["test", "--offline", "--quiet"])
        // The profile of the workspace, so that what it compiled is used again.
        .args([
            "--config",
            "profile.dev.panic=\"abort\"",
            "--config",
            "profile.dev.opt-level=1",
        ])
        .args(["--config", "profile.dev.package.\"*\".opt-level=2"])
        .args(["--config", "profile.dev.package.\"*\".debug=false"])
        .output()
        .expect("cargo runs");
    let said = text(&built);
    assert!(built.status.success(), "{said}");
    assert!(said.contains("1 passed"), "{said}");
}
