//! A few quick causes, injected by the program itself: as specified, nothing missed, nothing left.

use std::process::Command;

use serde_json::Value;

fn faults(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_faults"))
        .args(arguments)
        // The test's own build has made the programs; another one beside it would replace them.
        .env_remove("CARGO")
        .output()
        .expect("it starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_dead_daemon_halts_the_body_and_a_dead_layer_does_not() {
    let chosen = [
        "--seeds",
        "1",
        "--json",
        "--cause",
        "daemon-kill",
        "layer-kill",
        "inside-loop",
    ];
    let (code, report, said) = faults(&chosen);
    assert_eq!(code, Some(0), "{report}{said}");
    let report: Value = serde_json::from_str(&report).expect("the report is JSON");
    let causes = report["causes"].as_array().expect("a list");
    assert_eq!(causes.len(), 3);
    for cause in causes {
        let halted = cause["halt_periods"]["max"].as_f64();
        let expected = cause["expected"] == "halt";
        assert_eq!(halted.is_some(), expected, "{cause}");
        // Nothing halts before it is broken; the program itself judges the bound.
        assert!(halted.is_none_or(|periods| periods > 0.0), "{cause}");
        assert_eq!(cause["tried"], 1);
    }
}

#[test]
fn an_unknown_cause_is_bad_input() {
    let (code, _, said) = faults(&["--cause", "gremlins"]);
    assert_eq!(code, Some(2));
    assert!(
        said.contains("gremlins unknown; expected one or more of: layer-kill"),
        "{said}"
    );
}
