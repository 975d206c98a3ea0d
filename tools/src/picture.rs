//! Pictures of creature files.
//!
//! Must never keep silent about an error because a picture could be made of the rest.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use daemon::machine::kinds;
use graph::{Dress, Model};
use ipc::wiring::creature::Creature;
use ipc::wiring::diagnostic::Rejected;
use ipc::wiring::sketch::sketch;
use ipc::wiring::{Directory, Source, check};
use serde_json::{Value, json};

pub(crate) fn draw(files: &[PathBuf], as_dot: bool, output: Option<&Path>, as_json: bool) -> ExitCode {
    let sources = match read(files, as_json) {
        Ok(sources) => sources,
        Err(status) => return status,
    };
    let (model, rejected) = model(&sources);
    if !as_json {
        rejected.iter().for_each(|r| eprintln!("{r}"));
    }
    let text = if as_dot {
        graph::dot(&model)
    } else {
        graph::svg(&graph::draw(&model), Dress::File)
    };
    let errors: Vec<Value> = rejected
        .iter()
        .flat_map(Rejected::located)
        .map(|l| json!(l))
        .collect();
    let written = match output {
        Some(path) => {
            std::fs::write(path, &text).map_err(|e| format!("{}: cannot be written: {e}", path.display()))
        }
        None if as_json => Ok(()),
        None => std::io::stdout()
            .write_all(text.as_bytes())
            .map_err(|e| format!("the picture cannot be written: {e}")),
    };
    if as_json {
        println!("{}", describe(&model, as_dot, output, &text, &errors));
    }
    if let Err(message) = written {
        eprintln!("subsumectl: {message}");
        return ExitCode::FAILURE;
    }
    if errors.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    }
}

fn read(files: &[PathBuf], as_json: bool) -> Result<Vec<Source>, ExitCode> {
    let mut sources = Vec::new();
    let mut errors = Vec::new();
    for path in files {
        let name = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => sources.push(Source::of_file(path, text)),
            Err(e) => {
                let help = "expected the path of a creature file or a layer's manifest (TOML)";
                eprintln!("{name}: cannot be read: {e}; {help}");
                errors.push(json!({
                    "file": name, "line": 0, "column": 0, "message": e.to_string(), "help": help,
                }));
            }
        }
    }
    if errors.is_empty() {
        return Ok(sources);
    }
    if as_json {
        println!("{}", json!({ "errors": errors }));
    }
    Err(ExitCode::from(2))
}

/// The first source as a creature, each further one as a layer that joins it and all before; what was wrong.
fn model(sources: &[Source]) -> (Model, Vec<Rejected>) {
    let mut sound: Vec<Creature> = Vec::new();
    let mut rejected = Vec::new();
    let mut sketches = Vec::new();
    for (k, source) in sources.iter().enumerate() {
        let checked = match sound.first() {
            _ if k == 0 => check::creature(source, &kinds()),
            Some(host) => check::manifest(source, &kinds(), &directory(host, &sound[1..])),
            // Nobody knows what a creature that is not sound offers: its manifests are drawn unchecked.
            None => {
                sketches.push(sketch(source, None));
                continue;
            }
        };
        match checked {
            Ok(creature) => {
                sketches.push(sketch(source, None));
                sound.push(creature);
            }
            Err(r) => {
                sketches.push(sketch(source, Some(&r)));
                rejected.push(r);
            }
        }
    }
    (graph::of_sketches(&sketches), rejected)
}

/// What a creature shows to the next layer when others have joined.
fn directory(host: &Creature, joined: &[Creature]) -> Directory {
    let mut all = Directory::of(host, "");
    joined.iter().for_each(|layer| all.join_checked(layer));
    all
}

fn describe(model: &Model, as_dot: bool, output: Option<&Path>, text: &str, errors: &[Value]) -> Value {
    let bands: Vec<Value> = model
        .bands
        .iter()
        .map(|b| json!({"name": b.name, "level": b.level}))
        .collect();
    let taps = model.nets.iter().flat_map(|n| n.ends.iter().map(move |e| (n, e)));
    let taps: Vec<Value> = taps
        .filter_map(|(n, e)| Some((n, e, e.tap?)))
        .map(|(n, e, tap)| {
            let time_constant_ms = tap.time_constant.map(|t| t.as_millis_f64());
            json!({"kind": tap.how, "from": n.name, "to": e.to, "time_constant_ms": time_constant_ms,
                   "fault": e.fault})
        })
        .collect();
    let wires: Vec<Value> = model
        .nets
        .iter()
        .map(|n| {
            let to: Vec<&str> = n
                .ends
                .iter()
                .filter(|e| e.tap.is_none())
                .map(|e| e.to.as_str())
                .collect();
            json!({"from": n.name, "to": to})
        })
        .collect();
    let mut said = json!({
        "creature": model.name, "layers": bands, "wires": wires, "taps": taps, "errors": errors,
    });
    match output {
        Some(path) => said["output"] = json!(path.display().to_string()),
        None => said[if as_dot { "dot" } else { "svg" }] = json!(text),
    }
    said
}
