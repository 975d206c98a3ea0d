//! `replay`: a recording through the layers again, and where the outputs differ.
//!
//! Must never call two outputs equal that differ in a bit.

use std::path::Path;
use std::process::ExitCode;

use daemon::machine::kinds;
use daemon::replay::{self, Outcome};
use ipc::wiring::{Files, Source, check};
use serde_json::json;

/// Replays `file` through the creature in `creature`, or the recorded one.
pub(crate) fn replay(file: &Path, creature: Option<&Path>, as_json: bool) -> ExitCode {
    let bad = |message: String| {
        if as_json {
            println!("{}", json!({ "error": message }));
        }
        eprintln!("{message}");
        ExitCode::from(2)
    };
    let recording = match recording::read(file) {
        Ok(recording) => recording,
        Err(message) => return bad(message),
    };
    let mut source = match creature {
        None => Source::new(
            format!("creature file in {}", file.display()),
            recording.manifest.file.as_str(),
        ),
        Some(path) => match std::fs::read_to_string(path) {
            Ok(text) => Source::new(path.display().to_string(), text),
            Err(e) => return bad(format!("{}: cannot be read: {e}", path.display())),
        },
    };
    // The body is not built again: its sensors come from the recording, whatever files it was made from.
    source.files = Files::Unread;
    let mut checked = match check::creature(&source, &kinds()) {
        Ok(checked) => checked,
        Err(rejected) => return bad(rejected.to_string()),
    };
    checked.seed = recording.manifest.seed;
    let outcome = replay::replay(&recording, &checked, &kinds());
    let differing = outcome.differing();
    if as_json {
        println!("{}", json!({"differing": differing, "replay": outcome}));
    } else {
        print!("{}", text(&outcome));
    }
    if differing == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn text(outcome: &Outcome) -> String {
    let mut text = format!("{} beats, {:.1} s\n", outcome.beats, outcome.seconds);
    outcome
        .doubts
        .iter()
        .for_each(|doubt| text += &format!("note: {doubt}\n"));
    text += &format!(
        "{:<24} {:>10} {:>10} {:>10}\n",
        "output", "recorded", "replayed", "differing"
    );
    for (name, o) in &outcome.outputs {
        text += &format!(
            "{name:<24} {:>10} {:>10} {:>10}\n",
            o.recorded, o.replayed, o.differing
        );
        if let Some(first) = &o.first {
            let words = |w: &Option<Vec<f64>>| w.as_ref().map_or("nothing".into(), |w| format!("{w:?}"));
            text += &format!(
                "  first at {:.3} s (beat {}): recorded {}, replayed {}; last at {:.3} s\n",
                first.time_s,
                first.beat,
                words(&first.recorded),
                words(&first.replayed),
                o.last_s.unwrap_or(first.time_s)
            );
        }
    }
    text += &match outcome.differing() {
        0 => "no difference\n".to_string(),
        n => format!("{n} differences\n"),
    };
    text
}
