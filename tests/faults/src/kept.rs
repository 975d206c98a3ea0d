//! Kept outcomes: a file with one line for each trial, so that a run of days can be stopped, killed and gone on
//! with, and runs of several machines put together by joining their files.
//!
//! Must never forget a trial that was not as specified, nor count one twice.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::causes;
use crate::outcome::Outcome;

#[derive(Serialize, Deserialize)]
struct Line {
    cause: String,
    seed: u64,
    outcome: Outcome,
}

/// Outcomes by cause and seed; those of a file, where there is one, and what is added goes there at once.
pub(crate) struct Kept {
    file: Option<(PathBuf, File)>,
    known: BTreeMap<(String, u64), Outcome>,
}

impl Kept {
    /// Those of the file at `path`, which is made if it is not there. A last line without its end was being written
    /// when somebody pulled the plug: it is dropped, and that trial is made again.
    ///
    /// # Errors
    /// In words, with the line: it cannot be read, or holds something else. Nothing is written then.
    pub(crate) fn open(path: Option<&Path>) -> Result<Kept, String> {
        let Some(path) = path else {
            let known = BTreeMap::new();
            return Ok(Kept { file: None, known });
        };
        let failed = |e: std::io::Error| format!("{}: {e}", path.display());
        let text = match std::fs::read_to_string(path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
            read => read.map_err(failed)?,
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let known = read(&text[..whole]).map_err(|e| format!("{}:{e}", path.display()))?;
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .map_err(failed)?;
        file.set_len(whole as u64).map_err(failed)?;
        let file = Some((path.to_owned(), file));
        Ok(Kept { file, known })
    }

    /// What came of a trial, if it was made.
    pub(crate) fn outcome(&self, cause: &str, seed: u64) -> Option<&Outcome> {
        self.known.get(&(cause.to_owned(), seed))
    }

    /// Adds what came of a trial.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn add(&mut self, cause: &str, seed: u64, outcome: Outcome) -> Result<(), String> {
        if let Some((path, file)) = &mut self.file {
            let line = Line {
                cause: cause.to_owned(),
                seed,
                outcome: outcome.clone(),
            };
            let mut text = serde_json::to_string(&line).map_err(|e| e.to_string())?;
            text.push('\n');
            let written = file.write_all(text.as_bytes());
            written.map_err(|e| format!("{}: {e}", path.display()))?;
        }
        self.known.insert((cause.to_owned(), seed), outcome);
        Ok(())
    }

    /// Every outcome of a cause, by seed.
    pub(crate) fn of(&self, cause: &str) -> impl Iterator<Item = (u64, &Outcome)> {
        let from = (cause.to_owned(), 0)..=(cause.to_owned(), u64::MAX);
        let outcomes = self.known.range(from);
        outcomes.map(|((_, seed), outcome)| (*seed, outcome))
    }
}

fn read(text: &str) -> Result<BTreeMap<(String, u64), Outcome>, String> {
    let mut known = BTreeMap::new();
    for (number, line) in text.lines().enumerate() {
        let at = number + 1;
        let line: Line =
            serde_json::from_str(line).map_err(|e| format!("{at}: expected a trial's outcome: {e}"))?;
        if causes::find(&line.cause).is_none() {
            return Err(format!("{at}: no cause {:?}; see --list", line.cause));
        }
        let key = (line.cause, line.seed);
        // The same trial made twice, on two machines say: once it was broken, it is.
        if known
            .get(&key)
            .is_none_or(|before: &Outcome| before.broken.is_empty())
        {
            known.insert(key, line.outcome);
        }
    }
    Ok(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn broken() -> Outcome {
        Outcome {
            broken: vec!["too late".into()],
            ..Outcome::default()
        }
    }

    #[test]
    fn a_run_that_was_killed_in_the_middle_of_a_line_is_gone_on_with() {
        let path = std::env::temp_dir().join(format!("subsumed-kept-{}", std::process::id()));
        let name = causes::CAUSES[0].name;
        let mut kept = Kept::open(Some(&path)).expect("a new file");
        kept.add(name, 1, Outcome::default()).expect("written");
        kept.add(name, 2, broken()).expect("written");
        let text = std::fs::read_to_string(&path).expect("read");
        std::fs::write(&path, &text[..text.len() - 5]).expect("torn");
        let mut kept = Kept::open(Some(&path)).expect("the last line is dropped");
        assert!(kept.outcome(name, 1).is_some() && kept.outcome(name, 2).is_none());
        kept.add(name, 2, Outcome::default()).expect("written");
        assert_eq!(Kept::open(Some(&path)).expect("whole again").of(name).count(), 2);
        std::fs::write(&path, "{}\n").expect("something else");
        assert!(Kept::open(Some(&path)).is_err_and(|e| e.contains(":1: expected a trial's outcome")));
        assert_eq!(std::fs::read_to_string(&path).expect("read"), "{}\n");
        std::fs::remove_file(&path).expect("there");
    }

    #[test]
    fn of_two_outcomes_the_broken_one_counts() {
        let name = causes::CAUSES[0].name;
        let line = |outcome| {
            let line = Line {
                cause: name.into(),
                seed: 1,
                outcome,
            };
            serde_json::to_string(&line).expect("plain") + "\n"
        };
        for text in [
            line(broken()) + &line(Outcome::default()),
            line(Outcome::default()) + &line(broken()),
        ] {
            let known = read(&text).expect("two lines");
            assert_eq!(known[&(name.to_owned(), 1)].broken.len(), 1);
        }
    }
}
