//! Checking creature files.

use std::path::PathBuf;
use std::process::ExitCode;

use daemon::machine::kinds;
use ipc::wiring::{Source, check as checker};
use serde_json::json;

pub(crate) fn check(files: &[PathBuf], as_json: bool) -> ExitCode {
    let mut wrong = false;
    let mut found = Vec::new();
    for path in files {
        let name = path.display().to_string();
        let checked = match std::fs::read_to_string(path) {
            Ok(text) => checker::creature(&Source::new(&name, text), &kinds()),
            Err(e) => {
                wrong = true;
                let help = "expected the path of a creature file (TOML)";
                eprintln!("{name}: cannot be read: {e}; {help}");
                found.push(
                    json!({"file": name, "line": 0, "column": 0, "message": e.to_string(), "help": help}),
                );
                continue;
            }
        };
        match checked {
            Ok(creature) if !as_json => {
                let modules: usize = creature.layers.iter().map(|l| l.modules.len()).sum();
                println!(
                    "{name}: {} is sound ({} layers, {modules} modules)",
                    creature.name,
                    creature.layers.len()
                );
            }
            Ok(_) => {}
            Err(rejected) => {
                wrong = true;
                found.extend(rejected.located().into_iter().map(|l| json!(l)));
                if !as_json {
                    eprintln!("{rejected}");
                }
            }
        }
    }
    if as_json {
        println!("{}", json!({ "errors": found }));
    }
    if wrong {
        ExitCode::from(2)
    } else {
        ExitCode::SUCCESS
    }
}
