//! Files and folders of scenarios, run in parallel and told in order.
//!
//! Must never let the number of threads, or which is faster, change what is told.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use afsm::Kinds;
use ipc::wiring::Rejected;

use crate::judge::{Failure, judge};
use crate::plan::Scenario;
use crate::read;
use crate::run::{How, run};

/// Deepest folder that is looked into: deeper is a loop of links.
const DEPTH_MAX: usize = 16;

/// What came of one scenario.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Its file.
    pub path: PathBuf,
    /// What it is about.
    pub title: String,
    /// Highest level it needs.
    pub level: u8,
    /// How many expectations it has.
    pub expectations: usize,
    /// Simulated seconds.
    pub simulated_s: f64,
    /// Messages on all wires.
    pub messages: u64,
    /// Their hash.
    pub hash: u64,
    /// What was not as expected; it passed if nothing.
    pub failures: Vec<Failure>,
}

impl Verdict {
    /// Whether everything was as expected.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }
}

/// The scenario files in `paths`: files as given, of folders every TOML file with a `scenario` key, by name.
///
/// # Errors
/// The paths that cannot be read, each with what to do.
pub fn find(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Vec<String>> {
    let (mut found, mut wrong) = (Vec::new(), Vec::new());
    for path in paths {
        if !path.is_dir() {
            found.push(path.clone());
            continue;
        }
        let mut files = BTreeSet::new();
        if let Err(e) = walk(path, 0, &mut files) {
            wrong.push(format!(
                "{}: cannot be read: {e}; expected a folder of scenario files",
                path.display()
            ));
        } else if files.is_empty() {
            wrong.push(format!(
                "{}: no scenario in it; expected *.toml files with scenario = \"...\"",
                path.display()
            ));
        }
        found.extend(files);
    }
    if wrong.is_empty() { Ok(found) } else { Err(wrong) }
}

fn walk(folder: &Path, depth: usize, files: &mut BTreeSet<PathBuf>) -> std::io::Result<()> {
    if depth > DEPTH_MAX {
        return Ok(());
    }
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            walk(&path, depth + 1, files)?;
        } else if path.extension().is_some_and(|e| e == "toml")
            && read::is_scenario(&String::from_utf8_lossy(&std::fs::read(&path)?))
        {
            files.insert(path);
        }
    }
    Ok(())
}

/// Reads the scenario files.
///
/// # Errors
/// Every error of every file.
pub fn read_all(files: &[PathBuf], kinds: &Kinds) -> Result<Vec<Scenario>, Vec<Rejected>> {
    let (mut scenarios, mut rejected) = (Vec::new(), Vec::new());
    for file in files {
        match read::file(file, kinds) {
            Ok(scenario) => scenarios.push(scenario),
            Err(errors) => rejected.extend(errors),
        }
    }
    if rejected.is_empty() {
        Ok(scenarios)
    } else {
        Err(rejected)
    }
}

/// Runs one scenario and judges it.
pub fn try_one(scenario: &Scenario, kinds: &Kinds, how: How) -> Verdict {
    let outcome = run(scenario, kinds, how);
    Verdict {
        path: scenario.path.clone(),
        title: scenario.title.clone(),
        level: scenario.level,
        expectations: scenario.expectations.len(),
        simulated_s: scenario.duration.seconds(),
        messages: outcome.messages,
        hash: outcome.hash,
        failures: judge(scenario, &outcome),
    }
}

/// Does `work` with each of `items` on as many threads as there are processors; the results in their order.
pub fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            scope.spawn(|| {
                loop {
                    // Relaxed: the number is all that is shared; results go through the lock.
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(index) else { break };
                    let result = work(item);
                    done.lock()
                        .expect("nobody panics holding results")
                        .push((index, result));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("nobody panics holding results");
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}
