//! Bad input: a message with the place, exit status 2, nothing overwritten.

use std::process::{Command, Output};

use tempfile::TempDir;
use truckin::ootland::world_file;

fn truckin(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_truckin"))
        .args(args)
        .output()
        .expect("the command starts")
}

/// The faults of a world as `line:column: start of message`.
fn faults(text: &str) -> Vec<String> {
    match world_file::read(text) {
        Ok(_) => Vec::new(),
        Err(faults) => faults.iter().map(ToString::to_string).collect(),
    }
}

#[test]
fn every_fault_of_a_world_comes_with_line_and_column() {
    let cases = [
        (
            "avenues = 10\n[economy]\ncrate_cents = -5\n",
            "3:15: crate_cents: expected a whole number from 1",
        ),
        ("[economy]\ngas_cents = [90, -1]", "2:18: gas_cents"),
        (
            "[economy]\ngas_cents = [90, 80]",
            "2:13: gas_cents: lowest 90 is above highest 80",
        ),
        ("[economy]\nitem_cents = 1.5", "2:14: item_cents"),
        ("avenues = 0", "1:11: avenues"),
        ("streetz = 3", "1:1: a world has no \"streetz\""),
        (
            "[[dealer]]\nat = [1, 2]\nkind = \"bank\"",
            "3:9: expected one of none, producer, retailer, consumer, gas_station, found ",
        ),
        (
            "[[dealer]]\nat = [10, 2]\nkind = \"retailer\"",
            "2:6: no such corner",
        ),
        ("[[dealer]]\nkind = \"retailer\"", "1:1: a dealer needs at"),
        (
            "[[dealer]]\nat = [1, 2]\nkind = \"producer\"\nselling_cents = 5",
            "4:17: a producer sets no",
        ),
        (
            "avenues = 2\nstreets = 2",
            "1:1: 28 dealers do not fit on 4 corners",
        ),
        ("avenues = ", "1:11: not TOML"),
    ];
    for (text, expected) in cases {
        let faults = faults(text);
        assert!(
            faults.iter().any(|fault| fault.starts_with(expected)),
            "{text}\n{faults:?}"
        );
    }
}

#[test]
fn two_dealers_on_one_corner_and_a_negative_price_are_told_at_once() {
    let text = "[[dealer]]\nat = [1, 2]\nkind = \"retailer\"\nbuying_cents = -1\n\
                [[dealer]]\nat = [1, 2]\nkind = \"consumer\"\n";
    let faults = faults(text);
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(faults[0].starts_with("4:16: buying_cents"), "{faults:?}");
    assert!(
        faults[1].starts_with("6:6: a second dealer at avenue 1, street 2"),
        "{faults:?}"
    );
}

#[test]
fn world_check_says_where_and_exits_with_2() {
    let place = TempDir::new().expect("a folder");
    let file = place.path().join("w.toml");
    std::fs::write(&file, "avenues = 12\n[economy]\ncrate_cents = -5\n").expect("a file");
    let name = file.to_str().expect("a name");
    let done = truckin(&["world", "check", name]);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains("w.toml:3:15: crate_cents"));
    std::fs::write(&file, "avenues = 12\n").expect("a file");
    assert_eq!(truckin(&["world", "check", name]).status.code(), Some(0));
    assert_eq!(
        truckin(&["world", "check", "/nowhere.toml"]).status.code(),
        Some(2)
    );
}

#[test]
fn a_wrong_chromosome_is_told_with_its_digit() {
    let done = truckin(&["game", "0312", "0372", "03x2", "031"]);
    assert_eq!(done.status.code(), Some(2));
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(
        said.contains("\"03x2\", digit 3") && said.contains("\"031\": expected 4 digits, found 3"),
        "all of them at once: {said}"
    );
    assert!(
        said.contains("\"0372\", digit 3: expected 0 to 4 for trading, found '7'"),
        "{said}"
    );
    let done = truckin(&["game", "03122"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains("expected 4 digits, found 5"));
    assert_eq!(truckin(&["game", "0000", "--slots", "0"]).status.code(), Some(2));
}

#[test]
fn a_damaged_grid_is_refused_by_evolve_before_anything_is_played() {
    let place = TempDir::new().expect("a folder");
    let file = place.path().join("g.csv");
    std::fs::write(&file, "nonsense\n").expect("a file");
    let report = place.path().join("r.html");
    let (file, report) = (file.to_str().expect("a name"), report.to_str().expect("a name"));
    let done = truckin(&["evolve", "--grid", file, "--report", report]);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains("g.csv:1: expected a line beginning"));
    assert!(!std::path::Path::new(report).exists());
}

#[test]
fn json_of_a_game_is_one_object_a_slot() {
    let done = truckin(&["game", "2322", "4331", "--slots", "5", "--json", "--check"]);
    let text = String::from_utf8(done.stdout).expect("text");
    assert_eq!(text.lines().count(), 5);
    for line in text.lines() {
        let view: serde_json::Value = serde_json::from_str(line).expect("JSON");
        assert_eq!(view["trucks"].as_array().map(Vec::len), Some(2));
        assert_eq!(view["dealers"].as_array().map(Vec::len), Some(28));
    }
}
