//! Layout: the rules of the code base that a compiler does not know, as tests.
//!
//! Must never name a file that is excused from a rule without the reason standing beside it.

use std::fs;
use std::path::{Path, PathBuf};

/// Longest file of code, in lines: "about 400", with room for the last function.
const LINES_MAX: usize = 420;

/// Files that are longer and are to be divided; each must still be too long, or it leaves this list.
const OVERLONG: [&str; 0] = [];

/// Longest README of a crate, in lines: one page.
const README_LINES_MAX: usize = 120;

/// Names that say nothing about what is inside.
const EMPTY_NAMES: [&str; 6] = ["utils", "util", "common", "helpers", "manager", "misc"];

/// The folders of code.
const FOLDERS: [&str; 5] = ["ipc", "layers", "daemon", "tools", "tests"];

fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().expect("the crate lies in the workspace").into()
}

/// Every file below the folders of code whose name ends in `end`, with its path from the root.
fn files(end: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = FOLDERS.iter().map(|f| root().join(f)).collect();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder can be read").flatten() {
            let path = entry.path();
            let name = entry.file_name().to_string_lossy().into_owned();
            if path.is_dir() {
                if name != "target" && !name.starts_with('.') {
                    open.push(path);
                }
            } else if name.ends_with(end) {
                let short = path.strip_prefix(root()).expect("below the root");
                let text = fs::read_to_string(&path).expect("code is text");
                found.push((short.display().to_string(), text));
            }
        }
    }
    found.sort();
    assert!(
        found.len() > 5,
        "the walk found next to nothing that ends in {end}"
    );
    found
}

#[test]
fn unsafe_stands_only_where_the_architecture_names_it() {
    let architecture = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("there is ARCHITECTURE.md");
    let row = architecture.lines().find(|l| l.starts_with("| `unsafe` only in"));
    let named: Vec<&str> = row.expect("a row names the files").split('`').collect();
    let uses = |text: &str| {
        let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        code.flat_map(|l| l.split(|c: char| !c.is_alphanumeric() && c != '_'))
            .any(|word| word == "unsafe")
    };
    let here = file!().rsplit('/').next().unwrap_or_default();
    for (path, text) in files(".rs") {
        if uses(&text) && !path.ends_with(here) {
            assert!(
                named.contains(&path.as_str()),
                "{path} has unsafe code that ARCHITECTURE.md does not name"
            );
        }
    }
    let sources = files(".rs");
    for name in named.iter().filter(|n| n.ends_with(".rs")) {
        let (_, text) = sources
            .iter()
            .find(|(path, _)| path == name)
            .unwrap_or_else(|| panic!("ARCHITECTURE.md names {name}, which is not there"));
        assert!(uses(text), "{name} is named for unsafe code and has none");
    }
}

#[test]
fn every_file_has_a_title_and_one_idea() {
    let mut wrong = Vec::new();
    for (path, text) in files(".rs") {
        if !text.starts_with("//!") {
            wrong.push(format!("{path}: the first line is no //! title"));
        }
        let lines = text.lines().count();
        let overlong = OVERLONG.contains(&path.as_str());
        if overlong && lines <= LINES_MAX {
            wrong.push(format!("{path}: {lines} lines; no longer overlong"));
        }
        if lines > LINES_MAX && !overlong {
            wrong.push(format!("{path}: {lines} lines, more than {LINES_MAX}"));
        }
        let parts = Path::new(&path).components();
        for part in parts.filter_map(|p| p.as_os_str().to_str()) {
            if EMPTY_NAMES.contains(&part.trim_end_matches(".rs")) {
                wrong.push(format!("{path}: {part:?} says nothing about what is inside"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_crate_has_a_page_that_says_what_it_is() {
    for (path, text) in files("Cargo.toml") {
        if path.starts_with("tools/templates/") {
            continue; // no crate yet: `subsumectl new layer` makes one of it
        }
        let folder = Path::new(&path).parent().expect("a file lies in a folder");
        let name = folder.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        assert!(
            text.contains(&format!("name = \"{name}\"")),
            "{path}: the crate is not named after its folder"
        );
        let readme = root().join(folder).join("README.md");
        let page = fs::read_to_string(&readme).unwrap_or_else(|_| panic!("{path}: no README.md beside it"));
        let lines = page.lines().count();
        assert!(
            lines <= README_LINES_MAX,
            "{}: {lines} lines are more than a page",
            readme.display()
        );
    }
}

#[test]
fn layers_read_no_clock() {
    for (path, text) in files(".rs") {
        let behaviour = path.starts_with("layers/") && path.contains("/src/") && !path.contains("/command/");
        if behaviour {
            for clock in ["Instant::now", "SystemTime::now", "clock_gettime", "monotonic()"] {
                let excused = path.starts_with("layers/afsm/src/process/"); // the process, not the modules, keeps time
                assert!(excused || !text.contains(clock), "{path} reads a clock: {clock}");
            }
        }
    }
}

/// Files that ask for the date, for what they call a recording or write at its top. Nothing that beats, halts or
/// waits is among them: a step of the wall clock moves no deadline.
const DATED: [&str; 2] = [
    "daemon/src/recorder/flight.rs",
    "daemon/recording/src/manifest.rs",
];

#[test]
fn nothing_but_the_names_of_recordings_hangs_on_the_wall_clock() {
    for (path, text) in files(".rs") {
        let runs =
            ["ipc/", "layers/", "daemon/"].iter().any(|f| path.starts_with(f)) && path.contains("/src/");
        let wall = ["SystemTime", "ClockId::Realtime", "CLOCK_REALTIME", "UNIX_EPOCH"];
        let asks = wall.iter().any(|word| text.contains(word));
        if runs && asks {
            assert!(DATED.contains(&path.as_str()), "{path} reads the wall clock");
        }
    }
}

#[test]
fn layers_know_no_body() {
    for (path, text) in files("Cargo.toml") {
        if path.starts_with("layers/") {
            assert!(
                !text.contains("daemon"),
                "{path}: a layer knows behaviour and no body"
            );
        }
    }
}

#[test]
fn no_script_asks_the_end_of_a_pipe_that_leaves_early() {
    for (path, text) in files(".sh") {
        for (number, line) in text.lines().enumerate() {
            let pipes = line.replace("||", "").replace("| ", "|");
            // `grep -q` leaves at its first match; who still writes then dies of SIGPIPE, which `pipefail` takes for
            // the answer of the pipe. `grep -q PATTERN <<<"$(COMMAND)"` has no such race.
            let asks = pipes
                .split("|grep -")
                .skip(1)
                .any(|options| options.split(' ').next().is_some_and(|o| o.contains('q')));
            assert!(!asks, "{path}:{}: {line}", number + 1);
        }
    }
}
