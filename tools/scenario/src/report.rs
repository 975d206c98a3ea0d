//! What came of scenarios: for people, for programs, for continuous integration.
//!
//! Must never tell a time of the host but in JUnit's `time`.

use std::fmt::Write as _;

use graph::xml::escaped;
use serde_json::{Value, json};

use crate::judge::Failure;
use crate::suite::Verdict;

/// As test runners tell it.
pub fn text(verdicts: &[Verdict]) -> String {
    let mut out = String::new();
    for verdict in verdicts {
        let word = if verdict.passed() { "ok" } else { "FAILED" };
        let _ = writeln!(out, "{word:<6} {}: {}", verdict.path.display(), verdict.title);
    }
    for verdict in verdicts.iter().filter(|v| !v.passed()) {
        let _ = writeln!(out, "\n---- {}: {}", verdict.path.display(), verdict.title);
        for failure in &verdict.failures {
            let _ = write!(out, "{}", told(failure, &verdict.path.display().to_string()));
        }
    }
    let failed = verdicts.iter().filter(|v| !v.passed()).count();
    let word = if failed == 0 { "ok" } else { "FAILED" };
    let _ = writeln!(
        out,
        "\n{word}: {} passed, {failed} failed",
        verdicts.len() - failed
    );
    out
}

/// One failure in lines.
fn told(failure: &Failure, file: &str) -> String {
    let mut out = String::new();
    let place = if failure.line > 0 {
        format!("{file}:{}: ", failure.line)
    } else {
        String::new()
    };
    let _ = writeln!(out, "{place}expected {}", failure.expected);
    let _ = writeln!(out, "  but {}", failure.came);
    for line in &failure.around {
        let _ = writeln!(out, "    {line}");
    }
    if let Some(because) = &failure.because {
        let _ = writeln!(out, "  because {because}");
    }
    out
}

/// As one JSON document.
pub fn json(verdicts: &[Verdict]) -> Value {
    let failed = verdicts.iter().filter(|v| !v.passed()).count();
    let scenarios: Vec<Value> = verdicts.iter().map(one).collect();
    json!({ "passed": verdicts.len() - failed, "failed": failed, "scenarios": scenarios })
}

fn one(verdict: &Verdict) -> Value {
    let failure = |f: &Failure| {
        json!({
            "line": f.line, "expected": f.expected, "came": f.came, "around": f.around, "because": f.because,
        })
    };
    let failures: Vec<Value> = verdict.failures.iter().map(failure).collect();
    json!({
        "file": verdict.path.display().to_string(), "scenario": verdict.title, "level": verdict.level,
        "passed": verdict.passed(), "expectations": verdict.expectations,
        "simulated_s": verdict.simulated_s, "messages": verdict.messages,
        "hash": format!("{:016x}", verdict.hash), "failures": failures,
    })
}

/// As JUnit XML; `seconds` is how long each took on this host.
pub fn junit(verdicts: &[Verdict], seconds: &[f64]) -> String {
    let failed = verdicts.iter().filter(|v| !v.passed()).count();
    let total: f64 = seconds.iter().sum();
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        out,
        "<testsuite name=\"scenarios\" tests=\"{}\" failures=\"{failed}\" errors=\"0\" time=\"{total:.3}\">",
        verdicts.len()
    );
    for (verdict, seconds) in verdicts.iter().zip(seconds) {
        let file = verdict.path.display().to_string();
        let _ = write!(
            out,
            "  <testcase classname=\"{}\" name=\"{}\" time=\"{seconds:.3}\"",
            escaped(&file),
            escaped(&verdict.title)
        );
        if verdict.passed() {
            let _ = writeln!(out, "/>");
            continue;
        }
        let _ = writeln!(out, ">");
        for failure in &verdict.failures {
            let message = format!("expected {}", failure.expected);
            let text = told(failure, &file);
            let _ = writeln!(
                out,
                "    <failure message=\"{}\">{}</failure>",
                escaped(&message),
                escaped(&text)
            );
        }
        let _ = writeln!(out, "  </testcase>");
    }
    out.push_str("</testsuite>\n");
    out
}
