//! The overrun policies as scenarios on a scripted clock: the very loop of the real-time threads, beat by beat.

use super::*;
use ipc::wiring::creature::Overrun;

const PERIOD: Span = Span::millis(10);

/// A clock that stands still but for what the script says: how late each wake-up is, how long each beat takes.
struct Script<'s> {
    now: Time,
    late_us: &'s [u64],
    long_us: &'s [u64],
    turn: usize,
    reading: bool,
    stop: &'s AtomicBool,
}

impl Timing for Script<'_> {
    fn now(&mut self) -> Time {
        if self.reading {
            // The second look of a beat: it is over.
            self.now = self.now + Span::micros(self.long_us[self.turn]);
            self.turn += 1;
            if self.turn == self.long_us.len() {
                self.stop.store(true, Ordering::Relaxed);
            }
        }
        self.reading = !self.reading;
        self.now
    }

    fn wait(&mut self, due: Time, _: Wake) {
        self.now = self.now.max(due) + Span::micros(self.late_us.get(self.turn).copied().unwrap_or(0));
    }
}

/// Notes when it was beaten.
#[derive(Default)]
struct Diary(Vec<u64>);

impl Beats for Diary {
    fn beat(&mut self, now: Time) {
        self.0.push(now.0 / 1_000);
    }
}

struct Outcome {
    at_us: Vec<u64>,
    counts: gauge::BeatCounts,
    samples: Vec<Sample>,
    halted: bool,
}

/// Runs the loop; beats take `long_us` each, wake-ups are `late_us` late.
fn scenario(overrun: Overrun, late_us: &[u64], long_us: &[u64]) -> Outcome {
    let plan = Plan {
        name: "scripted".into(),
        period: PERIOD,
        phase: Span::millis(3),
        schedule: Schedule::Ordinary,
        cpu: None,
        wake: Wake::Sleep,
        overrun,
        sealed: true,
    };
    let stop = AtomicBool::new(false);
    let halt = HaltChannel::default();
    let gauge = Arc::new(BeatGauge::default());
    let (face, mut samples) = face(gauge.clone());
    let mut diary = Diary::default();
    let mut script = Script {
        now: Time::ZERO,
        late_us,
        long_us,
        turn: 0,
        reading: false,
        stop: &stop,
    };
    run(
        &plan,
        Time::ZERO,
        &mut diary,
        &mut [face],
        &halt,
        &stop,
        &mut script,
    );
    let standing = halt.latched();
    Outcome {
        at_us: diary.0,
        counts: gauge.counts(),
        samples: std::iter::from_fn(|| samples.pop().ok()).collect(),
        halted: standing.has(Causes::OVERRUN),
    }
}

#[test]
fn on_time_every_beat_comes_in_its_phase() {
    let o = scenario(Overrun::Skip, &[], &[1_000; 4]);
    assert_eq!(o.at_us, [3_000, 13_000, 23_000, 33_000]);
    assert_eq!(
        (
            o.counts.beats,
            o.counts.skipped,
            o.counts.missed,
            o.counts.overruns
        ),
        (4, 0, 0, 0)
    );
    assert!(!o.halted);
}

#[test]
fn skip_leaves_missed_beats_out_and_never_fires_a_burst() {
    // The second beat takes 34 ms: those due at 23, 33 and 43 ms are left out; the next comes at 53 ms.
    let o = scenario(Overrun::Skip, &[], &[1_000, 34_000, 1_000, 1_000]);
    assert_eq!(o.at_us, [3_000, 13_000, 53_000, 63_000]);
    assert_eq!((o.counts.beats, o.counts.skipped), (4, 3));
    assert_eq!(
        (o.counts.missed, o.counts.overruns, o.counts.identity_faults),
        (1, 1, 0)
    );
    assert!(!o.halted);
}

#[test]
fn catch_up_makes_missed_beats_up_back_to_back() {
    let o = scenario(
        Overrun::CatchUp,
        &[],
        &[1_000, 34_000, 1_000, 1_000, 1_000, 1_000, 1_000],
    );
    assert_eq!(o.at_us, [3_000, 13_000, 47_000, 48_000, 49_000, 53_000, 63_000]);
    assert_eq!((o.counts.beats, o.counts.skipped), (7, 0));
    // Late themselves: the beats due at 23 and 33 ms, made up at 47 and 48 ms; the one of 43 ms is in time.
    assert_eq!(
        (
            o.counts.missed,
            o.counts.missed_in_row,
            o.counts.missed_in_row_max
        ),
        (3, 0, 3)
    );
    assert_eq!(o.counts.overruns, 1, "only one ran too long");
}

#[test]
fn halt_closes_the_gate_at_the_first_missed_deadline_and_goes_on_beating() {
    let good = scenario(Overrun::Halt, &[], &[9_999, 10_000, 1_000]);
    assert!(!good.halted, "a beat that ends at its deadline met it");
    let o = scenario(Overrun::Halt, &[], &[1_000, 10_001, 1_000]);
    assert!(o.halted);
    assert_eq!(o.at_us, [3_000, 13_000, 33_000]);
    assert_eq!((o.counts.beats, o.counts.skipped, o.counts.missed), (3, 1, 1));
}

#[test]
fn a_late_release_counts_towards_the_deadline_but_is_no_overrun() {
    let o = scenario(Overrun::Skip, &[0, 8_000, 0], &[1_000, 3_000, 1_000]);
    assert_eq!(o.at_us, [3_000, 21_000, 33_000]);
    assert_eq!((o.counts.missed, o.counts.overruns, o.counts.skipped), (1, 0, 1));
    assert_eq!(o.samples[1].latency, Span::millis(8));
    assert_eq!(o.samples[1].step, Span::millis(3));
    assert_eq!(o.samples[1].response, Span::millis(11));
}

#[test]
fn misses_are_counted_in_all_and_in_a_row() {
    let o = scenario(
        Overrun::Skip,
        &[],
        &[11_000, 11_000, 1_000, 11_000, 1_000, 11_000, 11_000, 11_000],
    );
    assert_eq!(
        (
            o.counts.missed,
            o.counts.missed_in_row,
            o.counts.missed_in_row_max
        ),
        (6, 3, 3)
    );
}
