//! Growth: what the daemon and the body hold of memory, file descriptors and shared memory, from early to late.
//!
//! Must never compare moments: a layer that happens to be there is no growth. What is compared are the smallest
//! (descriptors, files) and the middle (memory) of two stretches of the run.

use std::ops::Range;

use ipc::clock::Span;
use serde::{Deserialize, Serialize};

/// What was held at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sample {
    at: Span,
    held: [u64; KINDS],
}

/// What is measured.
const KINDS: usize = 5;
const NAMES: [&str; KINDS] = [
    "the daemon's memory, KiB",
    "the body's memory, KiB",
    "the daemon's file descriptors",
    "the body's file descriptors",
    "files in /dev/shm",
];

/// How much more there may be late than early. Memory: a heap breaks up a little as events differ; a leak of one event
/// in a second shows as more within an hour.
const MORE_MAX: [u64; KINDS] = [1024, 512, 0, 0, 0];

/// How long it takes until all that is kept is there. The flight recorder is off: it may fill its 64 MiB for as long as
/// the last minute holds more than the one before.
const WARM_UP: Span = Span::secs(90);

const MINUTE: Span = Span::secs(60);

/// Shortest run of which growth is judged.
pub(super) const JUDGED_MIN: Span = Span::secs(300);

/// What was measured.
#[derive(Debug)]
pub(super) struct Growth {
    daemon: u32,
    body: u32,
    samples: Vec<Sample>,
}

/// One line of the comparison.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Line {
    /// What is held.
    pub(super) what: String,
    /// In the first third after the warm-up.
    pub(super) early: u64,
    /// In the last third.
    pub(super) late: u64,
    /// Most ever.
    pub(super) most: u64,
    /// How much more it may be late than early.
    pub(super) more_max: u64,
    /// The middle of each minute, for whoever asks whether it grows on or came to an end.
    pub(super) by_minute: Vec<u64>,
}

impl Growth {
    /// Of these two processes.
    pub(super) fn of(daemon: u32, body: u32) -> Growth {
        Growth {
            daemon,
            body,
            samples: Vec::new(),
        }
    }

    /// Looks once more, with so many files of shared memory there.
    pub(super) fn measure(&mut self, at: Span, files: usize) {
        let held = [
            memory_kib(self.daemon),
            memory_kib(self.body),
            descriptors(self.daemon),
            descriptors(self.body),
            files as u64,
        ];
        self.samples.push(Sample { at, held });
    }

    /// Early against late; nothing of a run that was too short.
    pub(super) fn lines(&self) -> Vec<Line> {
        let Some(last) = self.samples.last().filter(|s| s.at >= JUDGED_MIN) else {
            return Vec::new();
        };
        let third = (last.at.0 - WARM_UP.0) / 3;
        let early = WARM_UP.0..WARM_UP.0 + third;
        let late = last.at.0 - third..last.at.0 + 1;
        let of = |kind: usize, stretch: Range<u64>| {
            let held = self.held(kind, stretch);
            let place = if MORE_MAX[kind] > 0 { held.len() / 2 } else { 0 };
            held.get(place).copied().unwrap_or(0)
        };
        let minutes = |kind: usize| {
            let stretches = (0..last.at.0 / MINUTE.0).map(|n| n * MINUTE.0..(n + 1) * MINUTE.0);
            let held = stretches.map(|stretch| self.held(kind, stretch));
            held.filter_map(|held| held.get(held.len() / 2).copied())
                .collect()
        };
        (0..KINDS)
            .map(|kind| Line {
                what: NAMES[kind].into(),
                early: of(kind, early.clone()),
                late: of(kind, late.clone()),
                most: self.samples.iter().map(|s| s.held[kind]).max().unwrap_or(0),
                more_max: MORE_MAX[kind],
                by_minute: minutes(kind),
            })
            .collect()
    }

    /// What was held of a kind in a stretch of nanoseconds since the start, least first.
    fn held(&self, kind: usize, stretch: Range<u64>) -> Vec<u64> {
        let within = self.samples.iter().filter(|s| stretch.contains(&s.at.0));
        let mut held: Vec<u64> = within.map(|s| s.held[kind]).collect();
        held.sort_unstable();
        held
    }
}

impl Line {
    /// Whether it grew.
    pub(super) fn grew(&self) -> bool {
        self.late > self.early + self.more_max
    }
}

/// What a process has in memory.
fn memory_kib(pid: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    let number = line.and_then(|l| l.split_whitespace().next()?.parse().ok());
    number.unwrap_or(0)
}

fn descriptors(pid: u32) -> u64 {
    std::fs::read_dir(format!("/proc/{pid}/fd")).map_or(0, |entries| entries.count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(minutes: u64, held: impl Fn(u64) -> u64) -> Vec<Line> {
        let mut growth = Growth::of(0, 0);
        for second in (0..=60 * minutes).step_by(2) {
            let at = Span::secs(second);
            let held = [held(second); KINDS];
            growth.samples.push(Sample { at, held });
        }
        growth.lines()
    }

    #[test]
    fn what_comes_and_goes_is_no_growth_and_what_stays_is() {
        let busy = |second: u64| 5000 + 100 * (second / 2 % 3);
        assert!(after(10, busy).iter().all(|line| !line.grew()));
        // One more every ten seconds, beneath what comes and goes.
        let leaks = after(10, |second| busy(second) + second / 10);
        assert_eq!(
            leaks.iter().map(Line::grew).collect::<Vec<_>>(),
            [false, false, true, true, true]
        );
        let memory = after(60, |second| busy(second) + second);
        assert_eq!(memory[0].by_minute.len(), 60);
        assert!(memory[0].by_minute.is_sorted());
        assert!(memory.iter().all(Line::grew));
        assert!(after(4, busy).is_empty(), "too short to say");
    }

    #[test]
    fn this_process_has_memory_and_descriptors() {
        let own = std::process::id();
        assert!(memory_kib(own) > 100 && descriptors(own) > 2);
    }
}
