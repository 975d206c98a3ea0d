//! Paired rounds: ours and the reference at the same time, on one processor, half a period apart.
//!
//! ```text
//!   round 1:   |ours      |reference |ours      |reference |        one processor, one priority
//!   round 2:   |reference |ours      |reference |ours      |        phases swapped
//!   control:   |ours      |ours      |ours      |ours      |        two of our own: what the method itself adds
//! ```
//! Both keep a quarter of a period away from the full milliseconds: there the kernel's tick comes (since Linux 6.5 at
//! multiples of its own period), and on a virtual machine it takes tens of microseconds from whom it meets.
//!
//! Must never compare one after the other: a shared machine is another machine a second later.

use std::time::{Duration, Instant};

use daemon::executor::gauge::Sample;
use daemon::executor::{Plan, Schedule};
use ipc::clock::{self, Span, Time};
use ipc::wiring::creature::{Overrun, Wake};

use crate::cyclictest::{self, Cyclictest};
use crate::plant::Plant;
use crate::probe::{Host, Probe};
use crate::track::histogram;
use hdrhistogram::Histogram;

/// What rounds have in common.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The processor under test.
    pub cpu: usize,
    /// Where the reference's main thread prints.
    pub main_cpu: usize,
    /// SCHED_FIFO priority of both.
    pub priority: u8,
    /// Time between two beats.
    pub period: Span,
    /// How long ours spins before each beat where it does.
    pub spin: Span,
    /// How long a round is.
    pub round: Duration,
    /// What is planted in ours.
    pub plant: Option<Plant>,
}

/// What is compared in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contest {
    /// Two of our own threads: the control.
    Control,
    /// Ours by sleeping, against the reference.
    Sleep,
    /// Ours by spinning, against the reference.
    Spin,
}

/// All contests, in the order they are run.
pub const CONTESTS: [Contest; 3] = [Contest::Control, Contest::Sleep, Contest::Spin];

impl Contest {
    /// Its two sides.
    pub fn sides(self) -> (&'static str, &'static str) {
        match self {
            Contest::Control => ("ours-a", "ours-b"),
            Contest::Sleep => ("sleep", "cyclictest-beside-sleep"),
            Contest::Spin => ("spin", "cyclictest-beside-spin"),
        }
    }
}

/// One side of a round.
#[derive(Clone, Debug)]
pub struct Side {
    /// From due to running.
    pub wake_up: Histogram<u64>,
    /// By how much the time between two wake-ups was not the period.
    pub period_error: Histogram<u64>,
    /// From due to the end of the step; of the reference, which has none, to running.
    pub response: Histogram<u64>,
}

/// What a round showed.
#[derive(Clone, Debug)]
pub struct Round {
    /// What was compared.
    pub contest: Contest,
    /// Ours, and the other.
    pub sides: [Side; 2],
    /// What the host counted of our threads.
    pub host: Host,
    /// Beats of our threads while the host counted.
    pub beats: u64,
    /// What the host refused us.
    pub refusals: Vec<String>,
}

/// Part of a round that is left out at its beginning, one in so many: caches and idle states settle.
const WARM_UP: usize = 20;

/// How often samples are taken in.
const LOOK: Duration = Duration::from_millis(50);

/// Runs one round; `swapped` swaps the phases. `None` when `leave` says so before it is over.
///
/// # Errors
/// When a thread or the reference cannot be started.
pub fn round(
    setting: &Setting,
    contest: Contest,
    swapped: bool,
    leave: &dyn Fn() -> bool,
) -> std::io::Result<Option<Round>> {
    let (early, late) = (Span(setting.period.0 / 4), Span(setting.period.0 / 4 * 3));
    let (ours, other) = if swapped { (late, early) } else { (early, late) };
    let beats = (setting.round.as_nanos() as u64 / setting.period.0).max(1);
    // The reference begins at a full second of the monotonic clock. We are there before it: full seconds are
    // points of our grid, as a second is a whole number of periods.
    let soon = clock::monotonic() + Span::millis(100);
    let begin = Time((soon.0 / setting.period.0 + 1) * setting.period.0);
    let wake = match contest {
        Contest::Spin => Wake::Spin(setting.spin),
        _ => Wake::Sleep,
    };
    let mut first = Probe::start(plan(setting, "ours", ours, wake), begin, setting.plant)?;
    let refusals = first.refusals().iter().map(ToString::to_string).collect();
    let mut second = None;
    let mut reference = None;
    if contest == Contest::Control {
        second = Some(Probe::start(
            plan(setting, "ours-b", other, wake),
            begin,
            setting.plant,
        )?);
    } else {
        reference = Some(Cyclictest::start(&cyclictest::Setting {
            cpu: setting.cpu,
            main_cpu: setting.main_cpu,
            priority: setting.priority,
            period: setting.period,
            phase: other,
            loops: beats,
        })?);
    }
    let watched_from = begin + Span::millis(100);
    let mut watched = false;
    let limit = Instant::now() + setting.round + Duration::from_secs(5);
    let end = begin + Span(setting.round.as_nanos() as u64);
    loop {
        std::thread::sleep(LOOK);
        if leave() {
            return Ok(None);
        }
        if !watched && clock::monotonic() >= watched_from {
            first.watch();
            second.iter_mut().for_each(Probe::watch);
            watched = true;
        }
        first.drain();
        second.iter_mut().for_each(Probe::drain);
        let over = match &mut reference {
            Some(reference) => reference.ended(),
            None => clock::monotonic() >= end,
        };
        if over || Instant::now() >= limit {
            break;
        }
    }
    let first = first.finish();
    let (mut host, mut counted) = (first.host, first.samples.len() as u64);
    let ours = side(&latest(&first.samples, beats as usize));
    let other = match (second, reference) {
        (Some(second), _) => {
            let second = second.finish();
            host.faults += second.host.faults;
            host.sleeps += second.host.sleeps;
            counted += second.samples.len() as u64;
            side(&latest(&second.samples, beats as usize))
        }
        (None, Some(reference)) => side(&foreign(&reference.finish())),
        (None, None) => unreachable!("a round has two sides"),
    };
    Ok(Some(Round {
        contest,
        sides: [ours, other],
        host,
        beats: counted,
        refusals,
    }))
}

/// How one of our threads beats.
pub fn plan(setting: &Setting, name: &str, phase: Span, wake: Wake) -> Plan {
    Plan {
        name: name.into(),
        period: setting.period,
        phase,
        schedule: Schedule::Fifo(setting.priority),
        cpu: Some(setting.cpu),
        wake,
        overrun: Overrun::Skip,
        sealed: true,
    }
}

/// Wake-up and response of the last `n` beats.
fn latest(samples: &[Sample], n: usize) -> Vec<(u64, u64)> {
    let from = samples.len().saturating_sub(n);
    samples[from..]
        .iter()
        .map(|s| (s.latency.0, s.response.0))
        .collect()
}

fn foreign(latencies: &[u64]) -> Vec<(u64, u64)> {
    latencies.iter().map(|l| (*l, *l)).collect()
}

/// The histograms of one side, without its warm-up.
fn side(beats: &[(u64, u64)]) -> Side {
    let beats = &beats[beats.len() / WARM_UP..];
    let mut side = Side {
        wake_up: histogram(),
        period_error: histogram(),
        response: histogram(),
    };
    for (wake_up, response) in beats {
        side.wake_up.saturating_record((*wake_up).max(1));
        side.response.saturating_record((*response).max(1));
    }
    for two in beats.windows(2) {
        side.period_error
            .saturating_record(two[1].0.abs_diff(two[0].0).max(1));
    }
    side
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_is_made_of_its_beats_without_the_first_ones() {
        let beats: Vec<(u64, u64)> = (0..100)
            .map(|n| (if n < 5 { 1_000_000 } else { 1_000 + n % 2 }, 2_000))
            .collect();
        let side = side(&beats);
        assert_eq!((side.wake_up.len(), side.period_error.len()), (95, 94));
        assert!(side.wake_up.max() < 1_100 && side.period_error.max() == 1);
    }

    #[test]
    fn the_latest_beats_are_those_beside_the_reference() {
        let sample = |n: u64| Sample {
            due: Time(n),
            latency: Span(n),
            step: Span(1),
            response: Span(n + 1),
        };
        let samples: Vec<Sample> = (0..10).map(sample).collect();
        assert_eq!(latest(&samples, 3), [(7, 8), (8, 9), (9, 10)]);
        assert_eq!(latest(&samples, 30).len(), 10);
    }
}
