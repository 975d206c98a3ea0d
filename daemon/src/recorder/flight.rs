//! The flight recorder: a file of the last minute whenever the body halts for a reason that somebody will ask about.
//!
//! Must never fill a disk: it keeps a bounded number of files, and takes a rest between two.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

use ipc::clock::{Span, Time};
use recording::{Item, Manifest, Writer};

use super::listener::AFTER_HALT;
use crate::gate::Causes;
use crate::running::Shared;

/// Most files of one creature that are kept; the oldest goes first.
pub const FILES_MAX: usize = 16;

/// Shortest time between two files: a body that halts again and again would fill the disk with one story.
const REST: Span = Span::secs(10);

/// The flight recorder of one creature.
pub(super) struct Flight {
    folder: PathBuf,
    halted: Option<(Time, Causes)>,
    kept: Option<Time>,
    writing: Option<JoinHandle<()>>,
}

impl Flight {
    pub(super) fn new(folder: PathBuf) -> Flight {
        Flight {
            folder,
            halted: None,
            kept: None,
            writing: None,
        }
    }

    /// The body has halted for `causes`.
    pub(super) fn halted(&mut self, now: Time, causes: Causes) {
        let resting = self.kept.is_some_and(|kept| now.since(kept) < REST);
        if self.halted.is_none() && !resting {
            self.halted = Some((now, causes));
        }
    }

    /// Writes the file once the moments after the halt are in the ring too.
    pub(super) fn turn(&mut self, now: Time, shared: &Arc<Shared>, ring: impl FnOnce() -> Vec<Item>) {
        let Some((at, causes)) = self.halted else { return };
        let busy = self.writing.as_ref().is_some_and(|w| !w.is_finished());
        if now.since(at) < Span::nanos(AFTER_HALT.as_nanos() as u64) || busy {
            return;
        }
        self.halted = None;
        self.kept = Some(now);
        let (items, folder, shared) = (ring(), self.folder.clone(), shared.clone());
        let write = move || {
            let manifest = &shared.recorder.manifest;
            let text = match keep(&folder, manifest, causes, &items) {
                Ok(path) => format!("the flight recorder kept {}", path.display()),
                Err(e) => format!(
                    "the flight recorder could not keep a file in {}: {e}",
                    folder.display()
                ),
            };
            shared.events.note("daemon", None, text);
        };
        // Without a thread there is no file; the next halt tries again.
        self.writing = std::thread::Builder::new()
            .name("flight".into())
            .spawn(write)
            .ok();
    }

    /// Waits until a file that is being written is whole.
    pub(super) fn wait(&mut self) {
        if let Some(writing) = self.writing.take() {
            let _ = writing.join();
        }
    }
}

fn keep(
    folder: &Path,
    manifest: &Arc<Manifest>,
    causes: Causes,
    items: &[Item],
) -> mcap::McapResult<PathBuf> {
    std::fs::create_dir_all(folder)?;
    make_room(folder, &manifest.creature)?;
    let cause = causes
        .names()
        .first()
        .copied()
        .unwrap_or("halt")
        .replace(' ', "-");
    let path = folder.join(format!("{}-{}-{cause}.mcap", manifest.creature, time_of_day()));
    // Under another name until it is whole.
    let part = path.with_extension("part");
    let mut writer = Writer::new(std::io::BufWriter::new(std::fs::File::create(&part)?), manifest)?;
    for item in items {
        writer.write(item)?;
    }
    writer.finish()?;
    std::fs::rename(&part, &path)?;
    Ok(path)
}

/// Removes the oldest files of this creature, so that one more may come.
fn make_room(folder: &Path, creature: &str) -> std::io::Result<()> {
    let prefix = format!("{creature}-2");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            name.starts_with(&prefix) && (name.ends_with(".mcap") || name.ends_with(".part"))
        })
        .collect();
    // Their names sort by time.
    files.sort();
    let over = (files.len() + 1).saturating_sub(FILES_MAX);
    files.iter().take(over).try_for_each(std::fs::remove_file)
}

/// The time of day in UTC, as 20261121T170301Z.
fn time_of_day() -> String {
    let seconds = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default()
        .as_secs();
    let (year, month, day) = date(seconds / 86_400);
    let clock = seconds % 86_400;
    let (hour, minute, second) = (clock / 3600, clock / 60 % 60, clock % 60);
    format!("{year:04}{month:02}{day:02}T{hour:02}{minute:02}{second:02}Z")
}

/// Year, month and day of the `days`-th day after 1 January 1970.
fn date(mut days: u64) -> (u64, u64, u64) {
    let leap = |year: u64| year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    (year, month, days + 1)
}

/// Where flight recordings go if nothing else is said: `$STATE_DIRECTORY` (as systemd sets it), else
/// `$XDG_STATE_HOME/subsumed`, else `~/.local/state/subsumed`, else `flight` beside the control sockets.
pub fn default_folder() -> PathBuf {
    let set = |name: &str| {
        std::env::var_os(name)
            .filter(|v| !v.is_empty())
            .map(PathBuf::from)
    };
    set("STATE_DIRECTORY")
        .or_else(|| Some(set("XDG_STATE_HOME")?.join("subsumed")))
        .or_else(|| Some(set("HOME")?.join(".local/state/subsumed")))
        .unwrap_or_else(|| ipc::control::run_dir().join("flight"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        assert_eq!(date(0), (1970, 1, 1));
        assert_eq!(date(59), (1970, 3, 1));
        assert_eq!(date(11_016), (2000, 2, 29));
        assert_eq!(date(20_453), (2025, 12, 31));
        assert_eq!(date(20_454), (2026, 1, 1));
    }

    #[test]
    fn there_is_always_room_for_one_more() {
        let folder = std::env::temp_dir().join(format!("subsumed-flight-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder of our own");
        let name = |k: usize| folder.join(format!("toto-2026112{}T00000{}Z-halt.mcap", k / 10, k % 10));
        (0..FILES_MAX + 3).for_each(|k| std::fs::write(name(k), "").expect("a file"));
        std::fs::write(folder.join("mine.mcap"), "").expect("a file");
        make_room(&folder, "toto").expect("room");
        let left: Vec<bool> = (0..FILES_MAX + 3).map(|k| name(k).exists()).collect();
        let ours = folder.join("mine.mcap").exists();
        std::fs::remove_dir_all(&folder).expect("our own folder");
        assert_eq!(left.iter().filter(|there| **there).count(), FILES_MAX - 1);
        assert!(ours && !left[3] && left[4]);
    }
}
