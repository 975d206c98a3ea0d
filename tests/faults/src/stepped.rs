//! A realtime clock that is stepped under the daemon and a layer: by a library loaded before theirs, which answers
//! everybody who asks for the time of day.
//!
//! Must never step a clock of the host: other programs live by it.

use std::process::Command;

use crate::trial::{BODY, CREATURE, Trial, leave_body};

/// The library, in C: it takes the place of functions of the C library.
const SOURCE: &str = include_str!("stepped.c");

/// The daemon drives a body process, and a layer attaches and goes, while the time of day jumps ten times a second.
pub(crate) fn clock_stepped(trial: &mut Trial) -> Result<(), String> {
    let Some(library) = library(trial)? else {
        trial.outcome.skipped = Some("no C compiler (`cc`) for the library that steps the clock".into());
        return Ok(());
    };
    let stepped = [("LD_PRELOAD", library.as_str())];
    let mut body = trial.body()?;
    let arguments = [
        "--name",
        CREATURE,
        "--headless",
        "--body",
        BODY,
        "--seconds",
        &trial.life_s,
    ];
    let daemon = trial
        .stage
        .start_with(&trial.programs.subsumed, &arguments, &stepped)?;
    trial.wait_until_free(&daemon)?;
    trial.look_at_status()?;
    trial.goes_on_with(daemon, |trial| {
        trial.outcome.expect(jumps(&library), || {
            "the clock was not stepped: the library has no effect".into()
        });
        let mut wander = trial.wander_with(&stepped)?;
        // Two or three steps, with the layer's messages on their way.
        std::thread::sleep(std::time::Duration::from_millis(250));
        wander.leave()?;
        trial.told(&["layer wander", "detached"])
    })?;
    leave_body(trial, &mut body);
    for file in files(trial) {
        std::fs::remove_file(&file).map_err(|e| format!("{file}: {e}"))?;
    }
    Ok(())
}

/// The library's source and the library, on the stage.
fn files(trial: &Trial) -> [String; 2] {
    ["stepped.c", "stepped.so"].map(|name| trial.stage.run.join(name).display().to_string())
}

/// Builds the library on the stage; none where there is no compiler.
fn library(trial: &Trial) -> Result<Option<String>, String> {
    let [source, library] = files(trial);
    std::fs::write(&source, SOURCE).map_err(|e| format!("{source}: {e}"))?;
    let built = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o", &library, &source])
        .output();
    let built = match built {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        other => other.map_err(|e| format!("cc: {e}"))?,
    };
    match built.status.success() {
        true => Ok(Some(library)),
        false => Err(format!("cc: {}", String::from_utf8_lossy(&built.stderr))),
    }
}

/// Whether a program that asks for the time of day twice, two tenths of a second apart, sees it jump.
fn jumps(library: &str) -> bool {
    let ask = || {
        let output = Command::new("date")
            .arg("+%s")
            .env("LD_PRELOAD", library)
            .output();
        let text = String::from_utf8(output.ok()?.stdout).ok()?;
        text.trim().parse::<i64>().ok()
    };
    let first = ask();
    std::thread::sleep(std::time::Duration::from_millis(200));
    matches!((first, ask()), (Some(a), Some(b)) if (a - b).abs() > 60)
}
