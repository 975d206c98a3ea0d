//! Checking creature files, and explaining the kinds of module.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use daemon::machine::kinds;
use ipc::wiring::{Creature, Directory, Rejected, Source, check as checker, schema};
use serde_json::json;

use crate::paint::{self, Color};

/// What to check, and how to tell.
pub(crate) struct Wanted<'w> {
    pub(crate) files: &'w [PathBuf],
    /// The creature file that manifests are checked against, and manifests of layers that have joined it before.
    pub(crate) hosts: &'w [PathBuf],
    /// Whether every file is a manifest.
    pub(crate) manifests: bool,
    pub(crate) color: Color,
    pub(crate) json: bool,
}

/// A file that was read, and what it is.
struct Given {
    source: Source,
    /// What a manifest wants to join.
    host: Option<Directory>,
}

pub(crate) fn check(wanted: &Wanted<'_>) -> ExitCode {
    let mut found = Vec::new();
    let mut wrong = false;
    for path in wanted.files {
        let checked = given(path, wanted).and_then(|given| {
            let checked = match &given.host {
                None => checker::creature(&given.source, &kinds()),
                Some(host) => checker::manifest(&given.source, &kinds(), host),
            };
            checked.map(|c| (c, given.host)).map_err(Trouble::Rejected)
        });
        match checked {
            Ok((creature, host)) if !wanted.json => {
                println!("{}: {}", path.display(), sound(&creature, host))
            }
            Ok(_) => {}
            Err(trouble) => {
                wrong = true;
                found.extend(trouble.tell(path, wanted));
            }
        }
    }
    if wanted.json {
        println!("{}", json!({ "errors": found }));
    }
    if wrong {
        ExitCode::from(2)
    } else {
        ExitCode::SUCCESS
    }
}

fn sound(creature: &Creature, host: Option<Directory>) -> String {
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let modules = count(creature.layers.iter().map(|l| l.modules.len()).sum(), "module");
    match host {
        None => {
            let layers = count(creature.layers.len(), "layer");
            format!("{} is sound ({layers}, {modules})", creature.name)
        }
        Some(host) => {
            let name = creature.layers.first().map_or("", |l| l.name.as_str());
            format!("layer {name} is sound ({modules}) and may join {}", host.creature)
        }
    }
}

/// Why a file is not sound.
enum Trouble {
    Rejected(Rejected),
    Unreadable(String, &'static str),
}

impl Trouble {
    /// Tells a person, or gives what a program is told.
    fn tell(self, path: &Path, wanted: &Wanted<'_>) -> Vec<serde_json::Value> {
        match self {
            Trouble::Rejected(rejected) => {
                if !wanted.json {
                    paint::show(&rejected, wanted.color);
                }
                rejected.located().into_iter().map(|l| json!(l)).collect()
            }
            Trouble::Unreadable(message, help) => {
                let file = path.display().to_string();
                if !wanted.json {
                    eprintln!("{file}: {message}; {help}");
                }
                vec![json!({
                    "file": file, "line": 0, "column": 0, "rule": null, "message": message, "help": help,
                })]
            }
        }
    }
}

fn read(path: &Path) -> Result<Source, Trouble> {
    let bytes = std::fs::read(path).map_err(|e| {
        let help = "expected the path of a creature file or a manifest (TOML)";
        Trouble::Unreadable(format!("cannot be read: {e}"), help)
    })?;
    let source = Source::from_bytes(path.display().to_string(), bytes).map_err(Trouble::Rejected)?;
    Ok(source.beside(path))
}

/// The file at `path`: a creature file, or a manifest together with the creature it wants to join.
fn given(path: &Path, wanted: &Wanted<'_>) -> Result<Given, Trouble> {
    let source = read(path)?;
    let host = match wanted.hosts {
        [host, joined @ ..] => {
            let mut directory = directory(read(host)?)?;
            for path in joined {
                let manifest = checker::manifest(&read(path)?, &kinds(), &directory);
                directory.join_checked(&manifest.map_err(Trouble::Rejected)?);
            }
            Some(directory)
        }
        [] => match host_beside(path, &source) {
            Some(host) => Some(directory(read(&host)?)?),
            None if wanted.manifests => {
                let help = "name the creature file: subsumectl check --in CREATURE.toml FILE...";
                let message = "no creature file lies beside this manifest";
                return Err(Trouble::Unreadable(message.into(), help));
            }
            None => None,
        },
    };
    Ok(Given { source, host })
}

fn directory(source: Source) -> Result<Directory, Trouble> {
    let creature = checker::creature(&source, &kinds()).map_err(Trouble::Rejected)?;
    Ok(Directory::of(&creature, &creature.name))
}

/// The creature that a manifest in the same folder wants to join: a file without a body, whose creature has
/// its own file `<creature>.toml` with one there, is a manifest.
fn host_beside(path: &Path, source: &Source) -> Option<PathBuf> {
    let table: toml::Table = source.text.parse().ok()?;
    let creature = table.get("creature")?.as_str()?;
    if table.contains_key("body") {
        return None;
    }
    let host = path.with_file_name(format!("{creature}.toml"));
    let other: toml::Table = std::fs::read_to_string(&host).ok()?.parse().ok()?;
    let same = std::fs::canonicalize(&host).ok()? == std::fs::canonicalize(path).ok()?;
    (!same && other.contains_key("body")).then_some(host)
}

/// Prints the schema of creature files for editors.
pub(crate) fn schema() -> ExitCode {
    let schema = schema::schema(&kinds());
    println!("{schema:#}");
    ExitCode::SUCCESS
}
