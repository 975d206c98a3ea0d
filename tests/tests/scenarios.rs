//! Every scenario file of the project, straight and with its modules in any order; and a look at the runner
//! itself, which must be able to fail.

use std::path::{Path, PathBuf};

use scenario::plan::Scenario;
use scenario::run::How;
use scenario::suite::{self, Verdict};
use scenario::{kinds, read, report};

/// Where scenario files lie, from the root of the project.
const FOLDERS: [&str; 2] = ["tests/scenarios", "layers"];

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn all() -> Vec<Scenario> {
    let folders = FOLDERS.map(|folder| root().join(folder));
    let files = suite::find(&folders).unwrap_or_else(|wrong| panic!("{}", wrong.join("\n")));
    let scenarios = suite::read_all(&files, &kinds::kinds());
    scenarios.unwrap_or_else(|rejected| {
        let told: Vec<String> = rejected.iter().map(ToString::to_string).collect();
        panic!("{}", told.join("\n"))
    })
}

fn tried(scenarios: &[Scenario], shuffle: Option<u64>) -> Vec<Verdict> {
    let kinds = kinds::kinds();
    suite::in_parallel(scenarios, |s| suite::try_one(s, &kinds, How { shuffle }))
}

#[test]
fn every_scenario_passes_and_its_hash_does_not_hang_on_the_order_of_modules() {
    let scenarios = all();
    assert!(scenarios.len() > 30, "only {} scenarios found", scenarios.len());
    let straight = tried(&scenarios, None);
    assert!(
        straight.iter().all(Verdict::passed),
        "{}",
        report::text(&straight)
    );
    for shuffle in [Some(1), Some(2), None] {
        for (first, again) in straight.iter().zip(tried(&scenarios, shuffle)) {
            assert!(again.passed(), "{shuffle:?} {}", report::text(&[again]));
            assert_eq!(
                (first.hash, first.messages),
                (again.hash, again.messages),
                "{} with {shuffle:?}",
                first.path.display()
            );
        }
    }
}

/// The hash of one run, the same in debug and release, today and tomorrow. It changes when what Allen says
/// on any wire changes, be it the last bit of a heading: then write down the new one, and say why.
const GOLDEN: &str = "layers/allen/scenarios/level1/wander_is_heard.toml";
const GOLDEN_HASH: u64 = 0xced3_2fc5_607a_b23b;

#[test]
fn a_run_has_the_hash_it_always_had() {
    let kinds = kinds::kinds();
    let scenario = read::file(&root().join(GOLDEN), &kinds).expect("a scenario");
    for shuffle in [None, Some(7)] {
        let verdict = suite::try_one(&scenario, &kinds, How { shuffle });
        assert_eq!(verdict.hash, GOLDEN_HASH, "it is {:#018x} now", verdict.hash);
    }
}

/// The file `name` of the side-tap scenarios with one text replaced.
fn changed(name: &str, from: &str, to: &str) -> (PathBuf, String) {
    let path = root().join("tests/scenarios/taps").join(name);
    let text = std::fs::read_to_string(&path).expect("the file is there");
    assert!(text.contains(from), "{from:?} stands in {name}");
    (path, text.replacen(from, to, 1))
}

#[test]
fn a_wrong_expectation_fails_and_shows_what_came() {
    let kinds = kinds::kinds();
    let cases = [
        (
            "value = 5\n[[expect]]",
            "value = 6\n[[expect]]",
            "expected a message of 6 delivered to ear.value at 151ms",
            "151ms  5",
        ),
        (
            "count = 1\n",
            "none = true\n",
            "expected no message delivered to ear.value from 101ms until before 151ms",
            "101ms  100",
        ),
        (
            "rejected = 3",
            "rejected = 4",
            "expected the tap tap.value > ear.value rejects 4 messages",
            "but it rejects 3",
        ),
        (
            "holds = true",
            "holds = false",
            "does not hold at 150999999ns",
            "its window ends at 151ms",
        ),
        (
            "count = 5",
            "count = { max = 4 }",
            "expected at most 4 messages on wire.value in the whole run",
            "but 5 came",
        ),
    ];
    for (from, to, expected, came) in cases {
        let (path, text) = changed("suppress_window.toml", from, to);
        let source = ipc::wiring::Source::new("wrong.toml", text);
        let scenario = read::scenario(&path, source, &kinds).expect("a sound file");
        let verdict = suite::try_one(&scenario, &kinds, How::default());
        assert!(!verdict.passed(), "{to}");
        let told = report::text(&[verdict]);
        assert!(told.contains(expected) && told.contains(came), "{to}:\n{told}");
        assert!(told.contains("0 passed, 1 failed"), "{told}");
    }
}

#[test]
fn reports_for_programs_say_the_same() {
    let (path, text) = changed("suppress_window.toml", "count = 5", "count = 4");
    let kinds = kinds::kinds();
    let source = ipc::wiring::Source::new("wrong.toml", text);
    let scenario = read::scenario(&path, source, &kinds).expect("a sound file");
    let verdict = suite::try_one(&scenario, &kinds, How::default());
    let json = report::json(std::slice::from_ref(&verdict));
    assert_eq!(
        (json["passed"].as_u64(), json["failed"].as_u64()),
        (Some(0), Some(1))
    );
    let one = &json["scenarios"][0];
    assert_eq!(
        one["hash"].as_str(),
        Some(format!("{:016x}", verdict.hash).as_str())
    );
    assert_eq!(one["failures"][0]["came"].as_str(), Some("5 came"));
    let junit = report::junit(&[verdict], &[0.0]);
    assert!(junit.contains("tests=\"1\" failures=\"1\""), "{junit}");
    assert!(junit.contains("t &lt;= u &lt; t+tau"), "{junit}");
}

#[test]
fn a_bad_file_shows_every_error_with_its_place() {
    let text = "\
scenario = \"nothing is right\"
world = 3
creature = \"nowhere.toml\"
[[put]]
at = \"10\"
wire = \"a.b\"
valu = 1
[[plug]]
at = \"1s\"
layer = \"nobody\"
[[expect]]
wire = \"a.b\"
none = true
count = 3
[[expect]]
at = \"1s\"
[[expect]]
halted = true
cause = \"operater\"
[surprise]
";
    let source = ipc::wiring::Source::new("bad.toml", text);
    let rejected = read::scenario(Path::new("bad.toml"), source, &kinds::kinds());
    let rejected = rejected.expect_err("it is bad");
    let told: Vec<String> = rejected.iter().map(ToString::to_string).collect();
    let told = told.join("\n");
    for (place, message) in [
        ("bad.toml:2:9", "true or false"),
        ("bad.toml:3:12", "nowhere.toml"),
        ("bad.toml:5:6", "not a time"),
        ("bad.toml:7:1", "did you mean \"value\"?"),
        ("bad.toml:11:1", "none at once"),
        ("bad.toml:15:1", "about nothing"),
        ("bad.toml:19:9", "did you mean \"operator\"?"),
        ("bad.toml:20:2", "unknown key \"surprise\""),
    ] {
        assert!(
            told.contains(place) && told.contains(message),
            "{place} {message}:\n{told}"
        );
    }
}
