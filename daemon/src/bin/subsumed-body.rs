//! `subsumed-body`: runs a creature's simulated body in a process of its own, for `subsumed --body NAME`.

use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use daemon::body::{self, process};
use daemon::machine::kinds;
use daemon::options::BodyOptions;
use ipc::wiring::{Source, check};

fn main() -> ExitCode {
    match read(BodyOptions::parse()) {
        Ok(body) => process::main(body),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// The body that the creature file describes.
fn read(options: BodyOptions) -> Result<process::Body, String> {
    let source = match &options.creature {
        None => Source::new("allen.toml (built in)", allen::CREATURE),
        Some(path) => {
            let expected = "expected the path of a creature file (TOML)";
            let text = std::fs::read_to_string(path)
                .map_err(|e| format!("{}: cannot be read: {e}; {expected}", path.display()))?;
            Source::of_file(path, text)
        }
    };
    let creature = check::creature(&source, &kinds()).map_err(|rejected| rejected.to_string())?;
    let name = options.name.unwrap_or(creature.name);
    if !daemon::is_name(&name) {
        return Err(format!("--name {name:?}: {}", daemon::NAME_EXPECTED));
    }
    let limit = options.seconds.map(Duration::try_from_secs_f64).transpose();
    let limit = limit.map_err(|e| format!("--seconds: {e}; expected a number of seconds above zero"))?;
    let spec = creature
        .body
        .ok_or_else(|| format!("{}: the creature has no [body] to run", source.name))?;
    let kind = body::find(spec.declaration.name).ok_or("the kind of body is not built in")?;
    let seed = options.seed.unwrap_or(creature.seed);
    Ok(process::Body {
        name,
        kind,
        period: spec.period,
        world: (kind.build)(&spec.settings, seed, None),
        limit,
    })
}
