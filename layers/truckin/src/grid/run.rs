//! Plays an experiment on any number of threads into one file, going on where an earlier run stopped.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use super::block::{COLUMNS, play_block};
use super::experiment::Experiment;
use super::fault::GridFault;
use super::results::{self, Results};

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Blocks in the file.
    pub blocks: usize,
    /// Truck-slots in the file.
    pub truck_slots: u64,
}

/// Plays whatever the file at `path` does not hold yet and tells `progress` after each block, which may break it off:
/// what was played is kept, and the next run goes on from there.
///
/// A file that does not exist is begun. One that exists is first checked as a whole; if it is damaged
/// or holds another experiment, nothing is written. Bytes are only ever added at its end.
///
/// # Errors
/// See [`GridFault`].
///
/// # Panics
/// When `threads` is 0.
pub fn run(
    experiment: &Experiment,
    path: &Path,
    threads: usize,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), GridFault> {
    assert!(threads > 0, "at least one thread");
    let mut file = open(path)?;
    let before = results::read_results(path)?;
    let mut tail = begin(experiment, path, &before, &mut file)?;
    let first = before.blocks;
    let mut done = Progress {
        blocks: first,
        truck_slots: experiment.truck_slots(first),
    };
    if progress(done).is_break() {
        return Ok(());
    }
    play_in_order(experiment, first, threads, |index, text| {
        let rest = after_tail(path, &before, &tail, text.as_bytes())?;
        file.write_all(rest)
            .map_err(|error| GridFault::io(path, "writing", error))?;
        tail.clear();
        done.blocks += 1;
        done.truck_slots += experiment.block(index).truck_slots();
        Ok(progress(done))
    })?;
    file.sync_all()
        .map_err(|error| GridFault::io(path, "writing", error))
}

fn open(path: &Path) -> Result<File, GridFault> {
    let file = OpenOptions::new().create(true).append(true).open(path);
    let file = file.map_err(|error| GridFault::io(path, "opening", error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(GridFault::bad(path, 1, "another run is writing to this file")),
        Err(TryLockError::Error(error)) => Err(GridFault::io(path, "locking", error)),
    }
}

/// Writes the first two lines if they are not there; returns what is there of the next block.
fn begin(
    experiment: &Experiment,
    path: &Path,
    before: &Results,
    file: &mut File,
) -> Result<Vec<u8>, GridFault> {
    let settings = experiment.settings();
    if before.settings.is_empty() {
        let head = format!("{settings}\n{COLUMNS}\n");
        let rest = after_tail(path, before, &before.tail, head.as_bytes())?;
        file.write_all(rest)
            .map_err(|error| GridFault::io(path, "writing", error))?;
        return Ok(Vec::new());
    }
    if before.settings != settings {
        let what = format!(
            "holds another experiment:\n  it has {}\n  not {settings}",
            before.settings
        );
        return Err(GridFault::bad(path, 1, what));
    }
    if before.blocks > experiment.blocks()
        || (before.blocks == experiment.blocks() && !before.tail.is_empty())
    {
        return Err(GridFault::bad(
            path,
            before.tail_line,
            "goes on after the last block",
        ));
    }
    Ok(before.tail.clone())
}

/// What is left to write of `text` when `tail` is already there. A tail that is not how the text
/// begins is damage, not the trace of a stopped run.
fn after_tail<'t>(path: &Path, before: &Results, tail: &[u8], text: &'t [u8]) -> Result<&'t [u8], GridFault> {
    text.strip_prefix(tail).ok_or_else(|| {
        let same = tail
            .iter()
            .zip(text)
            .take_while(|(one, other)| one == other)
            .count();
        let line = before.tail_line + tail[..same].iter().filter(|byte| **byte == b'\n').count();
        GridFault::bad(path, line, "damaged: not what this experiment writes here")
    })
}

/// Plays all blocks from `first` on and hands each to `write`, in order, until it breaks off.
fn play_in_order(
    experiment: &Experiment,
    first: usize,
    threads: usize,
    mut write: impl FnMut(usize, String) -> Result<ControlFlow<()>, GridFault>,
) -> Result<(), GridFault> {
    let next = AtomicUsize::new(first);
    let blocks = experiment.blocks();
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::sync_channel(2 * threads);
        for _ in 0..threads {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                loop {
                    // Relaxed: the counter only hands out numbers; the channel carries the results.
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= blocks
                        || sender
                            .send((index, play_block(experiment, experiment.block(index))))
                            .is_err()
                    {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let mut early = BTreeMap::new();
        let mut due = first;
        for (index, text) in receiver {
            early.insert(index, text?);
            while let Some(text) = early.remove(&due) {
                if write(due, text)?.is_break() {
                    // With the channel gone every thread ends after the block that it plays.
                    return Ok(());
                }
                due += 1;
            }
        }
        Ok(())
    })
}
