//! Every prefix of Allen's stack works, whatever the layers above do; and a look at the check itself, which
//! must be able to fail.

use std::path::{Path, PathBuf};

use daemon::virtual_run::Manifest;
use ipc::wiring::{Directory, Source, check};
use scenario::prefixes::{Prefix, Upper, Way, prefixes, table};
use scenario::{kinds, suite};

fn allen(file: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../layers/allen")).join(file)
}

fn source(file: &str) -> Source {
    let text = std::fs::read_to_string(allen(file)).expect("the file is there");
    Source::new(file, text)
}

/// What comes of Allen with level 1 above, where the scenarios whose files are in `promised` count as
/// competences, whether they say so or not.
fn tried(promised: &[&str]) -> Vec<Prefix> {
    let kinds = kinds::kinds();
    let creature = check::creature(&source("allen.toml"), &kinds).expect("a creature");
    let manifest = Manifest {
        source: source("wander.toml"),
        table: None,
    };
    let wander = Upper::new(manifest, &mut Directory::of(&creature, "allen"), &kinds).expect("a layer");
    let files = suite::find(&[allen("scenarios")]).expect("scenarios");
    let mut scenarios = suite::read_all(&files, &kinds).expect("sound files");
    for scenario in &mut scenarios {
        scenario.competence |= promised.iter().any(|p| scenario.path.ends_with(p));
    }
    prefixes(&scenarios, &[wander], 1, &[1, 2, 3, 4, 5], &kinds)
}

#[test]
fn levels_0_and_1_of_allen_work_whatever_is_above() {
    let tried = tried(&[]);
    assert!(tried.iter().all(Prefix::passed), "{}", table(&tried));
    let meddled = tried.iter().find(|p| p.level == 0 && p.way == Way::Meddled);
    let meddled = meddled.expect("level 0 with level 1 above");
    assert!(
        meddled.meddled.0 > 30 && meddled.meddled.1 > 15,
        "{}",
        table(&tried)
    );
}

#[test]
fn a_promise_that_the_layer_above_breaks_is_found() {
    // With level 1 above it does not sit still: that is what level 1 is for.
    let tried = tried(&["level0/sits_still.toml"]);
    let failed: Vec<(u8, Way)> = tried
        .iter()
        .filter(|p| !p.passed())
        .map(|p| (p.level, p.way))
        .collect();
    assert_eq!(failed, [(0, Way::Meddled), (1, Way::Alone)], "{}", table(&tried));
    assert!(table(&tried).contains("every message on forward.speed is 0"));
}
