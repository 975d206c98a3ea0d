//! Running scenario files.
//!
//! Must never print a time of the host: the same files give the same text.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use afsm::Kinds;
use ipc::wiring::Rejected;
use scenario::plan::Scenario;
use scenario::run::How;
use scenario::{kinds, report, suite};
use serde_json::json;

/// What to run, and how to tell.
pub(crate) struct Wanted<'w> {
    pub(crate) paths: &'w [PathBuf],
    pub(crate) filter: Option<&'w str>,
    pub(crate) shuffle: Option<u64>,
    pub(crate) junit: Option<&'w Path>,
    pub(crate) json: bool,
}

/// The scenarios in `paths`, or the status to leave with when their errors are told.
pub(crate) fn read(paths: &[PathBuf], kinds: &Kinds, as_json: bool) -> Result<Vec<Scenario>, ExitCode> {
    let files = suite::find(paths).map_err(|wrong| {
        wrong.iter().for_each(|w| eprintln!("{w}"));
        if as_json {
            println!("{}", json!({ "errors": wrong }));
        }
        ExitCode::from(2)
    })?;
    suite::read_all(&files, kinds).map_err(|rejected| refuse(&rejected, as_json))
}

/// Tells every error of bad files.
pub(crate) fn refuse(rejected: &[Rejected], as_json: bool) -> ExitCode {
    for one in rejected {
        eprintln!("{one}\n");
    }
    if as_json {
        let errors: Vec<_> = rejected.iter().flat_map(Rejected::located).collect();
        println!("{}", json!({ "errors": errors }));
    }
    ExitCode::from(2)
}

pub(crate) fn test(wanted: &Wanted<'_>) -> ExitCode {
    let kinds = kinds::kinds();
    let mut scenarios = match read(wanted.paths, &kinds, wanted.json) {
        Ok(scenarios) => scenarios,
        Err(code) => return code,
    };
    if let Some(filter) = wanted.filter {
        scenarios.retain(|s| s.title.contains(filter) || s.path.display().to_string().contains(filter));
        if scenarios.is_empty() {
            eprintln!("no scenario's title or path has {filter:?} in it");
            return ExitCode::from(2);
        }
    }
    let how = How {
        shuffle: wanted.shuffle,
    };
    let results = suite::in_parallel(&scenarios, |scenario| {
        let begun = Instant::now();
        let verdict = suite::try_one(scenario, &kinds, how);
        (verdict, begun.elapsed().as_secs_f64())
    });
    let (verdicts, seconds): (Vec<_>, Vec<_>) = results.into_iter().unzip();
    if wanted.json {
        println!("{}", report::json(&verdicts));
    } else {
        print!("{}", report::text(&verdicts));
    }
    if let Some(path) = wanted.junit
        && let Err(e) = std::fs::write(path, report::junit(&verdicts, &seconds))
    {
        eprintln!(
            "{}: cannot be written: {e}; choose another --junit FILE",
            path.display()
        );
        return ExitCode::from(2);
    }
    if verdicts.iter().all(suite::Verdict::passed) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
