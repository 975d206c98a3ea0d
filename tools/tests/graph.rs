//! `subsumectl graph` as a shell meets it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subsumectl"))
        .arg("graph")
        .args(arguments)
        .output()
        .expect("the program runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("it writes text")
}

fn allen(file: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../layers/allen");
    root.join(file).display().to_string()
}

/// A file that goes when the test ends.
struct Draft(PathBuf);

impl Draft {
    fn new(name: &str, text: &str) -> Draft {
        let path = std::env::temp_dir().join(format!("subsumectl-graph-{}-{name}", std::process::id()));
        std::fs::write(&path, text).expect("a file for the test");
        Draft(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().expect("an ordinary path")
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn allen_and_a_layer_that_joins_it() {
    let files = [allen("allen.toml"), allen("wander.toml")];
    let drawn = run(&[&files[0], "--layers", &files[1]]);
    assert_eq!(drawn.status.code(), Some(0), "{}", text(&drawn.stderr));
    let svg = text(&drawn.stdout);
    for part in [
        "data-wire=\"sonar.map\"",
        "data-tap=\"avoid.heading&gt;turn.heading\"",
        "data-module=\"wander\"",
        "data-level=\"1\"",
        ">2 s<",
        "<title>",
        "<desc>",
    ] {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(!svg.contains("class=\"net fault\""));
    let again = run(&[&files[0], &files[1]]);
    assert_eq!(again.stdout, drawn.stdout, "the same files give the same bytes");
    let dot = text(&run(&["--dot", &files[0], &files[1]]).stdout);
    assert!(dot.starts_with("digraph") && dot.contains("S\\n2 s"), "{dot}");
}

const BAD: &str = r#"
creature = "bad"
[[layer]]
name = "low"
level = 0
period = "10ms"
wires = ["a.out -> b.x", "a.out -> b.no", "a.typo -> c.x", "nobody.out -> c.y", "c.out -> b.x"]
inhibit = [{ from = "a.out", output = "c.out" }]
[layer.modules]
a = { kind = "no.such.kind" }
b = { kind = "allen.forward", <<<
"#;

const WRONG: &str = r#"
creature = "wrong"
[[layer]]
name = "low"
level = 0
period = "10ms"
wires = ["body.sonar -> sonar.echo", "sonar.map -> collide.map", "sonar.map -> runaway.force", "sonar.mop -> collide.pose"]
[layer.modules]
sonar = { kind = "allen.sonar" }
collide = { kind = "allen.collide" }
runaway = { kind = "allen.runaway" }
[[layer]]
name = "high"
level = 1
period = "20ms"
suppress = [{ from = "feel.force", input = "runaway.force" }]
wires = ["sonar.map -> feel.map", "nobody.out -> feel.map"]
[layer.modules]
feel = { kind = "allen.feelforce" }
[body]
kind = "office"
"#;

#[test]
fn what_is_wrong_is_red_and_said() {
    let file = Draft::new("wrong.toml", WRONG);
    let drawn = run(&[file.path()]);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(
        text(&drawn.stderr).contains("wrong.toml:16:"),
        "{}",
        text(&drawn.stderr)
    );
    let svg = text(&drawn.stdout);
    let faulty = |to: &str| svg.contains(&format!("fault\" data-to=\"{to}\""));
    assert!(faulty("runaway.force"), "a tap without a time constant");
    assert!(svg.contains("class=\"tap fault\""));
    assert!(
        svg.contains("data-module=\"nobody\""),
        "a module that is not there"
    );
    assert!(
        svg.contains("data-wire=\"sonar.mop\""),
        "a port that is not there"
    );
    assert!(
        svg.contains("data-wire=\"sonar.map\"") && !faulty("collide.map"),
        "what is right stays black"
    );
    let json = text(&run(&["--json", file.path()]).stdout);
    let said: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert!(said["errors"].as_array().is_some_and(|e| !e.is_empty()));
    assert!(said["svg"].as_str().is_some_and(|s| s.starts_with("<svg")));
}

#[test]
fn broken_text_is_drawn_as_far_as_it_goes() {
    let file = Draft::new("bad.toml", BAD);
    let out = Draft::new("bad.svg", "");
    let drawn = run(&[file.path(), "-o", out.path()]);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(drawn.stdout.is_empty() && !drawn.stderr.is_empty());
    let svg = std::fs::read_to_string(&out.0).expect("it was written");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(run(&["/nowhere/at/all.toml"]).status.code(), Some(2));
}
