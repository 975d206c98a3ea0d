//! Running scenario files.
//!
//! Must never print a time of the host: the same files give the same text.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

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

pub(crate) fn test(wanted: &Wanted<'_>) -> ExitCode {
    let kinds = kinds::kinds();
    let files = match suite::find(wanted.paths) {
        Ok(files) => files,
        Err(wrong) => {
            wrong.iter().for_each(|w| eprintln!("{w}"));
            if wanted.json {
                println!("{}", json!({ "errors": wrong }));
            }
            return ExitCode::from(2);
        }
    };
    let mut scenarios = match suite::read_all(&files, &kinds) {
        Ok(scenarios) => scenarios,
        Err(rejected) => {
            for one in &rejected {
                eprintln!("{one}");
            }
            if wanted.json {
                let errors: Vec<_> = rejected.iter().flat_map(|r| r.located()).collect();
                println!("{}", json!({ "errors": errors }));
            }
            return ExitCode::from(2);
        }
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
