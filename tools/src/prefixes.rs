//! Trying every prefix of a creature's stack.
//!
//! Must never print a time of the host: the same files give the same text.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use daemon::virtual_run::Manifest;
use ipc::wiring::{Directory, Rejected, Source, check};
use scenario::kinds;
use scenario::prefixes::{Prefix, Upper, json, prefixes as try_all, table};

use crate::test::{read, refuse};

pub(crate) fn prefixes(
    creature: &Path,
    layers: &[PathBuf],
    scenarios: &[PathBuf],
    seeds: u64,
    as_json: bool,
) -> ExitCode {
    let kinds = kinds::kinds();
    let load = |path: &Path| {
        let name = path.display().to_string();
        std::fs::read_to_string(path)
            .map(|text| Source::of_file(path, text))
            .map_err(|e| {
                eprintln!("{name}: cannot be read: {e}; expected the path of a TOML file");
                ExitCode::from(2)
            })
    };
    let told = |rejected: Rejected| refuse(&[rejected], as_json);
    let checked = || -> Result<_, ExitCode> {
        let creature = check::creature(&load(creature)?, &kinds).map_err(told)?;
        let mut host = Directory::of(&creature, &creature.name);
        let mut uppers = Vec::new();
        for layer in layers {
            let manifest = Manifest {
                source: load(layer)?,
                table: None,
            };
            uppers.push(Upper::new(manifest, &mut host, &kinds).map_err(told)?);
        }
        let mut scenarios = read(scenarios, &kinds, as_json)?;
        scenarios.retain(|s| s.creature.name == creature.name);
        if scenarios.is_empty() {
            eprintln!("no scenario is about a creature called {:?}", creature.name);
            return Err(ExitCode::from(2));
        }
        Ok((creature, uppers, scenarios))
    };
    let (creature, uppers, scenarios) = match checked() {
        Ok(all) => all,
        Err(code) => return code,
    };
    let own = creature.layers.iter().map(|l| l.level);
    let top = own.chain(uppers.iter().map(|u| u.level)).max().unwrap_or(0);
    let seeds: Vec<u64> = (1..=seeds).collect();
    let tried = try_all(&scenarios, &uppers, top, &seeds, &kinds);
    if as_json {
        println!("{}", json(&tried));
    } else {
        print!("{}", table(&tried));
    }
    if tried.iter().all(Prefix::passed) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
