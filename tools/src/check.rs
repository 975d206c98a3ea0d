//! Checking creature files, and explaining the kinds of module.

use std::path::PathBuf;
use std::process::ExitCode;

use daemon::machine::kinds;
use ipc::wiring::catalog::{Declaration, Takes};
use ipc::wiring::diagnostic::one_of;
use ipc::wiring::{Catalog, Port, Source, check as checker};
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

pub(crate) fn modules(name: Option<&str>, as_json: bool) -> ExitCode {
    let mut known = kinds().modules();
    known.sort_by_key(|d| d.name);
    if let Some(name) = name {
        known.retain(|d| d.name == name);
        if known.is_empty() {
            let all = kinds().modules();
            eprintln!(
                "unknown kind of module {name:?}; {}",
                one_of("kind", name, all.iter().map(|d| d.name))
            );
            return ExitCode::from(2);
        }
    }
    if as_json {
        let shown: Vec<_> = known.iter().map(|d| describe(d)).collect();
        println!("{}", json!({ "modules": shown }));
    } else if name.is_some() {
        known.iter().for_each(|d| explain(d));
    } else {
        known.iter().for_each(|d| println!("{:<20} {}", d.name, d.about));
    }
    ExitCode::SUCCESS
}

fn describe(d: &Declaration) -> serde_json::Value {
    let ports = |ports: &[Port]| {
        let port = |p: &Port| json!({"name": p.name, "type": p.kind, "unit": p.unit, "about": p.about});
        ports.iter().map(port).collect::<Vec<_>>()
    };
    let parameters: Vec<_> = d
        .parameters
        .iter()
        .map(|p| json!({"name": p.name, "takes": takes(&p.takes), "unit": p.unit, "about": p.about}))
        .collect();
    json!({
        "name": d.name, "about": d.about, "diagram": d.diagram,
        "inputs": ports(d.inputs), "outputs": ports(d.outputs), "parameters": parameters,
    })
}

fn explain(d: &Declaration) {
    println!(
        "{}: {}\n\n  {}\n",
        d.name,
        d.about,
        d.diagram.replace('\n', "\n  ")
    );
    let ports = |what: &str, ports: &[Port]| {
        for p in ports {
            println!(
                "  {what:<9} {:<12} {:<8} {:<6} {}",
                p.name, p.kind, p.unit, p.about
            );
        }
    };
    ports("input", d.inputs);
    ports("output", d.outputs);
    for p in d.parameters {
        println!(
            "  {:<9} {:<12} {:<15} {}",
            "parameter",
            p.name,
            format!("{} {}", takes(&p.takes), p.unit),
            p.about
        );
    }
}

fn takes(takes: &Takes) -> String {
    let default = |d: Option<String>| d.map_or("(must be given)".into(), |d| format!("= {d}"));
    match takes {
        Takes::Number { default: d, .. } => default(d.map(|n| n.to_string())),
        Takes::Span { default: d } => default(d.map(|s| format!("{:?}", s.to_string()))),
        Takes::Bit { default: d } => default(d.map(|b| b.to_string())),
        Takes::Word { default: d, words } => format!("{} of {words:?}", default(d.map(|w| format!("{w:?}")))),
        Takes::Spans { .. } => "some times".into(),
        Takes::Numbers { default: d, .. } => default(d.map(|n| format!("{n:?}"))),
    }
}
