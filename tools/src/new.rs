//! Files to start from: a creature, a layer that joins one, a layout of an office.
//!
//! Must never overwrite anything: a folder that is there already is left as it is.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Subcommand;
use daemon::machine::kinds;
use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::creature::{Creature, PortName, Reads};
use ipc::wiring::{Source, check as checker};
use serde_json::json;

/// What to start.
#[derive(Subcommand, Debug)]
pub(crate) enum New {
    /// A commented creature file with a scenario
    Creature {
        /// The creature's name, and that of the folder
        name: String,
    },
    /// The floor plan of an office, commented, for `layout_file = "..."` of the body "office"
    Layout {
        /// The layout's name; the file is NAME.layout.toml
        name: String,
    },
    /// A layer in Rust with manifest and scenario; `cargo test` and `cargo run` work in it
    Layer {
        /// The layer's name, and that of the folder
        name: String,
        /// The creature it is to join (default: allen)
        #[arg(long = "in", value_name = "CREATURE.toml")]
        host: Option<PathBuf>,
        /// Where the crates of subsumed lie (default: where this program was built from, else crates.io)
        #[arg(long, value_name = "PATH")]
        crates: Option<PathBuf>,
    },
}

/// A file to write: its path in the folder, and its text with `@WORDS@` to be filled in.
type Template = (&'static str, &'static str);

const CREATURE: &[Template] = &[
    ("@NAME@.toml", include_str!("../templates/creature/creature.toml")),
    (
        "scenarios/level0.toml",
        include_str!("../templates/creature/scenario.toml"),
    ),
    ("README.md", include_str!("../templates/creature/README.md")),
];

const LAYOUT: &str = include_str!("../templates/layout/layout.toml");

const LAYER: &[Template] = &[
    ("Cargo.toml", include_str!("../templates/layer/Cargo.toml")),
    ("@NAME@.toml", include_str!("../templates/layer/layer.toml")),
    ("src/main.rs", include_str!("../templates/layer/main.rs")),
    ("src/@MODULE@.rs", include_str!("../templates/layer/module.rs")),
    (
        "src/scenarios.rs",
        include_str!("../templates/layer/scenarios.rs"),
    ),
    (
        "scenarios/sway.toml",
        include_str!("../templates/layer/scenario.toml"),
    ),
    ("README.md", include_str!("../templates/layer/README.md")),
];

/// Writes what is wanted.
pub(crate) fn new(what: &New, as_json: bool) -> ExitCode {
    let written = match what {
        New::Creature { name } => name_of(name).and_then(|()| creature(name)),
        New::Layout { name } => name_of(name).and_then(|()| layout(name)),
        New::Layer { name, host, crates } => {
            name_of(name).and_then(|()| layer(name, host.as_deref(), crates.as_deref()))
        }
    };
    match written {
        Ok(files) if as_json => println!("{}", json!({ "written": files })),
        Ok(files) => files.iter().for_each(|f| println!("{}", f.display())),
        Err(message) => {
            if as_json {
                println!("{}", json!({ "error": message }));
            }
            eprintln!("subsumectl: {message}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// A name that is one for creatures, layers, modules and packages alike.
fn name_of(name: &str) -> Result<(), String> {
    const NAME_MAX: usize = 32;
    let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_".contains(c);
    let sound = name.len() <= NAME_MAX
        && name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(letters);
    // Names of modules of the template, of its dependencies, and of the body.
    let taken = [
        "body",
        "source",
        "scenarios",
        "main",
        "afsm",
        "ipc",
        "scenario",
        "test",
        "self",
        "mod",
    ];
    if sound && !taken.contains(&name) {
        return Ok(());
    }
    Err(format!(
        "{name:?} cannot be used as a name; expected up to {NAME_MAX} small letters, digits, '-' or '_', a letter \
         first, and none of {}",
        taken.join(", ")
    ))
}

fn creature(name: &str) -> Result<Vec<PathBuf>, String> {
    write(name, CREATURE, &[("@NAME@", name)])
}

fn layout(name: &str) -> Result<Vec<PathBuf>, String> {
    let path = PathBuf::from(format!("{name}.layout.toml"));
    let kept = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::AlreadyExists => format!("{} is there already", path.display()),
        _ => format!("{}: {e}", path.display()),
    };
    let mut file = std::fs::File::create_new(&path).map_err(kept)?;
    std::io::Write::write_all(&mut file, LAYOUT.replace("@NAME@", name).as_bytes()).map_err(kept)?;
    Ok(vec![path])
}

fn layer(name: &str, host: Option<&Path>, crates: Option<&Path>) -> Result<Vec<PathBuf>, String> {
    let source = match host {
        None => Source::new("allen.toml", allen::CREATURE),
        Some(path) => {
            let text = std::fs::read_to_string(path).map_err(|e| {
                format!(
                    "{}: cannot be read: {e}; expected a creature file",
                    path.display()
                )
            })?;
            Source::of_file(path, text)
        }
    };
    let creature = checker::creature(&source, &kinds()).map_err(|rejected| rejected.to_string())?;
    let joint = joint(&creature)?;
    let module = format!("{}_sway", name.replace('-', "_"));
    let [afsm, ipc, scenario] = dependencies(crates)?;
    let outsiders = &creature.outsiders;
    let time_constant = Span::secs(2)
        .max(outsiders.time_constant_min)
        .min(outsiders.time_constant_max);
    let (from, to) = (joint.from.to_string(), joint.to.to_string());
    if creature.layers.iter().any(|l| l.name == name)
        || creature
            .layers
            .iter()
            .flat_map(|l| &l.modules)
            .any(|m| m.name == name)
    {
        return Err(format!(
            "{} has a layer or a module {name:?} already",
            creature.name
        ));
    }
    let speech = joint.speech;
    let words: &[(&str, &str)] = &[
        ("@NAME@", name),
        ("@MODULE@", &module),
        ("@CREATURE@", &creature.name),
        ("@LEVEL@", &joint.level.to_string()),
        ("@PERIOD@", &joint.period.to_string()),
        ("@FROM@", &from),
        ("@TO@", &to),
        ("@UNIT@", joint.unit),
        ("@KIND@", speech.kind),
        ("@TYPE@", speech.of),
        ("@TYPES@", speech.types),
        ("@MORE@", speech.more),
        ("@LESS@", speech.less),
        ("@BY@", speech.by.unwrap_or(joint.unit)),
        ("@PUT@", speech.put),
        ("@OVER@", speech.over),
        ("@UNDER@", speech.under),
        ("@MOUTH@", speech.mouth),
        ("@TAU@", &time_constant.to_string()),
        ("@AFSM@", &afsm),
        ("@IPC@", &ipc),
        ("@SCENARIO@", &scenario),
    ];
    write(name, LAYER, words)
}

/// What differs in a new layer by the type of its messages.
struct Speech {
    takes: Kind,
    kind: &'static str,
    of: &'static str,
    types: &'static str,
    more: &'static str,
    less: &'static str,
    /// Unit of the sway, if it is not the port's.
    by: Option<&'static str>,
    mouth: &'static str,
    put: &'static str,
    over: &'static str,
    under: &'static str,
}

/// The types of message that a new layer can be made for.
static SPEECHES: [Speech; 2] = [
    Speech {
        takes: Kind::Number,
        kind: "Number",
        of: "f64",
        types: "Kind",
        more: "heard + self.by",
        less: "heard - self.by",
        by: None,
        mouth: "source",
        put: "1.0",
        over: "1.25",
        under: "0.75",
    },
    Speech {
        takes: Kind::Polar,
        kind: "Polar",
        of: "Polar",
        types: "{Kind, Polar}",
        more: "Polar { bearing: heard.bearing + self.by, ..heard }",
        less: "Polar { bearing: heard.bearing - self.by, ..heard }",
        by: Some("rad"),
        mouth: "source.polar",
        put: "[2.0, 1.0]",
        over: "[2.0, 1.25]",
        under: "[2.0, 0.75]",
    },
];

/// Where a new layer joins a creature.
struct Joint {
    speech: &'static Speech,
    from: PortName,
    to: PortName,
    unit: &'static str,
    level: u8,
    period: Span,
}

/// The first input that is open to taps, takes a number or a polar message and has a wire that outsiders may read.
fn joint(creature: &Creature) -> Result<Joint, String> {
    let readable = |name: &PortName| match &creature.outsiders.read {
        Reads::All => true,
        Reads::These(these) => these.contains(name),
    };
    for layer in &creature.layers {
        if layer.level >= creature.outsiders.level_max {
            continue;
        }
        for wire in layer.wires.iter().filter(|w| readable(&w.from)) {
            let module = layer.modules.iter().find(|m| m.name == wire.to.module);
            let port = module.and_then(|m| m.declaration.input(&wire.to.port));
            if let Some((_, port)) = port
                && let Some(speech) = SPEECHES.iter().find(|t| t.takes == port.kind)
                && creature.outsiders.tap.contains(&wire.to)
            {
                return Ok(Joint {
                    speech,
                    from: wire.from.clone(),
                    to: wire.to.clone(),
                    unit: port.unit,
                    level: layer.level + 1,
                    period: layer.period,
                });
            }
        }
    }
    Err(format!(
        "{} opens no input that takes a number or a polar message; expected one in [outsiders] tap = [...] whose wire outsiders may read",
        creature.name
    ))
}

/// How the new package finds the crates it needs: by path, or by version.
fn dependencies(crates: Option<&Path>) -> Result<[String; 3], String> {
    const FOLDERS: [&str; 3] = ["layers/afsm", "ipc", "tools/scenario"];
    let built_from = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let holds = |root: &Path| FOLDERS.iter().all(|f| root.join(f).join("Cargo.toml").is_file());
    let root = match crates {
        Some(given) if holds(given) => given,
        Some(given) => {
            let help = "expected the folder of subsumed's source, with layers/afsm, ipc and tools/scenario";
            return Err(format!("the crates do not lie in {}; {help}", given.display()));
        }
        None => match built_from.filter(|root| holds(root)) {
            Some(root) => root,
            None => return Ok(FOLDERS.map(|_| format!("version = {:?}", env!("CARGO_PKG_VERSION")))),
        },
    };
    let root = std::fs::canonicalize(root).map_err(|e| format!("{}: {e}", root.display()))?;
    Ok(FOLDERS.map(|folder| format!("path = {:?}", root.join(folder).display().to_string())))
}

fn write(name: &str, files: &[Template], words: &[(&str, &str)]) -> Result<Vec<PathBuf>, String> {
    let fill = |text: &str| {
        words
            .iter()
            .fold(text.to_string(), |text, (word, meant)| text.replace(word, meant))
    };
    std::fs::create_dir(name).map_err(|e| match e.kind() {
        std::io::ErrorKind::AlreadyExists => {
            format!("{name} is there already; choose another name, or move it away")
        }
        _ => format!("{name}: cannot be made: {e}; choose a folder that you may write to"),
    })?;
    let mut written = Vec::new();
    for (path, text) in files {
        let path = Path::new(name).join(fill(path));
        let folder = path.parent().unwrap_or(Path::new(name));
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&path, fill(text)))
            .map_err(|e| format!("{}: cannot be written: {e}", path.display()))?;
        written.push(path);
    }
    Ok(written)
}
