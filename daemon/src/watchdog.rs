//! The watchdog: looks after everything that beats, from above all layers in priority.
//!
//! ```text
//!   every beat:  vital layers and motor unit beat in time?      ──no──► standing: vital layer late (latches)
//!                layers under policy halt within their period?  ──no──► standing: overrun (latches)
//!                what the motor unit passes on fresh?           ──no──► standing: stale command
//!                                      finite and in range?     ──no──► standing: unsound command
//!                nobody vital late  ──► progress + 1 ──► feeder, an ordinary thread ──► systemd, device
//! ```
//! It says what stands; the gate in the motor unit closes on it, and looks after the watchdog in turn. A motor
//! unit that hangs cannot close anything: then the body's own gate does, commands going stale.
//!
//! Must never call the system, allocate or wait: feeding is left to an ordinary thread (see
//! [`feeder`](crate::feeder)) that is tied to the progress counted here.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::{Span, Time};
use ipc::wire::{AHEAD_MAX, Limits, Reader};

use crate::executor::gauge::BeatGauge;
use crate::gate::Causes;
use crate::halt::HaltChannel;

/// Beats that a vital thread may miss before the body halts: one is a hiccup of the host, two are a fault.
const VITAL_BEATS_MAX: u64 = 2;

/// Least lateness that counts, whatever the period: gaps of 10 to 30 ms are a virtual host's own.
const VITAL_LATE_MIN: Span = Span::millis(50);

/// Something that must beat in time.
#[derive(Clone, Debug)]
pub struct Vital {
    /// Its name.
    pub name: String,
    /// Its beats.
    pub gauge: Arc<BeatGauge>,
    /// Later than this after its last beat it is late.
    late: Span,
}

impl Vital {
    /// What beats every `period`.
    pub fn new(name: &str, gauge: Arc<BeatGauge>, period: Span) -> Vital {
        Vital {
            name: name.into(),
            gauge,
            late: Span((period.0 * (VITAL_BEATS_MAX + 1)).max(VITAL_LATE_MIN.0)),
        }
    }

    /// Whether it has missed its beats; `thawed` is when this process last came out of a freeze. What never
    /// beat is not late: it has not begun.
    pub fn is_late(&self, now: Time, thawed: Time) -> bool {
        let counts = self.gauge.counts();
        counts.beats > 0 && now.since(counts.last.max(thawed)) > self.late
    }
}

/// A layer that halts the body when it runs over its period. The executor says so at the end of such a beat;
/// the watchdog does so in the middle of one that does not end.
#[derive(Clone, Debug)]
pub struct Strict {
    /// Its beats.
    pub gauge: Arc<BeatGauge>,
    /// Its period.
    pub period: Span,
}

impl Strict {
    /// A beat that ended at e was due at e or before; the next is due a period later at most, and has a
    /// period to run.
    fn overruns(&self, now: Time, thawed: Time) -> bool {
        let counts = self.gauge.counts();
        counts.beats > 0 && now.since(counts.last.max(thawed)) > Span(2 * self.period.0)
    }
}

/// Notices when the whole process was frozen (SIGSTOP, a debugger, a suspended host): somebody who looks after
/// others must not blame them for what it slept through itself. Commands have gone stale meanwhile, which
/// halts the body at both ends; whoever does not beat again in time after the thaw is late then.
#[derive(Clone, Copy, Debug)]
pub struct Thaw {
    /// Longest time between two looks that is no freeze.
    gap: Span,
    last: Time,
    thawed: Time,
}

impl Thaw {
    /// For somebody who looks every `period`.
    pub fn new(period: Span) -> Thaw {
        Thaw {
            gap: Span((2 * period.0).max(VITAL_LATE_MIN.0)),
            last: Time::ZERO,
            thawed: Time::ZERO,
        }
    }

    /// When the last freeze ended, as of `now`.
    pub fn at(&mut self, now: Time) -> Time {
        if now.since(self.last) > self.gap {
            self.thawed = now;
        }
        self.last = now;
        self.thawed
    }
}

/// The watchdog.
#[derive(Debug)]
pub struct Watchdog {
    /// Vital layers, and the motor unit.
    pub vital: Vec<Vital>,
    /// Layers under policy halt.
    pub strict: Vec<Strict>,
    /// What the motor unit passes on to the body, as far as it moves something.
    pub commands: Vec<(Reader, Limits)>,
    /// How old that may be.
    pub stale: Span,
    /// Where causes are said.
    pub channel: Arc<HaltChannel>,
    /// Goes up with every look that finds everybody vital in time.
    pub progress: Arc<AtomicU64>,
    /// Notices freezes.
    pub thaw: Thaw,
}

impl Watchdog {
    /// Looks at everything.
    pub fn look(&mut self, now: Time) {
        let thawed = self.thaw.at(now);
        let mut standing = Causes::NONE;
        let mut stands = |stands: bool, cause: Causes| {
            if stands {
                standing = standing.with(cause);
            }
        };
        let late = self.vital.iter().any(|v| v.is_late(now, thawed));
        stands(late, Causes::VITAL);
        stands(
            self.strict.iter().any(|s| s.overruns(now, thawed)),
            Causes::OVERRUN,
        );
        for (reader, limits) in &self.commands {
            // None yet, or being written just now: the gate knows whether one is missing.
            let Some(reading) = reader.read() else { continue };
            let fresh = reading.stamp <= now + AHEAD_MAX && now.since(reading.stamp) <= self.stale;
            stands(!fresh, Causes::STALE);
            let sound = limits.kind.accepts(&reading.words, limits.low, limits.high);
            stands(!sound, Causes::UNSOUND);
        }
        self.channel.watch(standing);
        if !late {
            // Relaxed: one thread writes, the feeder only looks whether it moves.
            let progress = self.progress.load(Ordering::Relaxed);
            self.progress.store(progress + 1, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ipc::message::{Kind, WORDS_MAX};
    use ipc::wire::{Page, Writer};

    fn ms(n: u64) -> Time {
        Time(n * 1_000_000)
    }

    fn watchdog() -> (Watchdog, Writer) {
        let page = Page::in_memory(1);
        let limits = Limits {
            kind: Kind::Number,
            low: -2.0,
            high: 2.0,
        };
        let gauge = Arc::new(BeatGauge::default());
        let watchdog = Watchdog {
            vital: vec![Vital::new("avoid", gauge.clone(), Span::millis(10))],
            strict: vec![Strict {
                gauge,
                period: Span::millis(10),
            }],
            commands: vec![(page.reader(0, Kind::Number).expect("it is there"), limits)],
            stale: Span::millis(100),
            channel: Arc::default(),
            progress: Arc::default(),
            thaw: Thaw::new(Span::millis(20)),
        };
        (watchdog, page.writer(0, Kind::Number).expect("it is free"))
    }

    fn progress(w: &Watchdog) -> u64 {
        w.progress.load(Ordering::Relaxed)
    }

    #[test]
    fn a_late_vital_layer_stands_and_stops_the_progress() {
        let (mut watchdog, _writer) = watchdog();
        let gauge = watchdog.vital[0].gauge.clone();
        let mut look = |now| {
            watchdog.look(ms(now));
            (watchdog.channel.watched(), progress(&watchdog))
        };
        assert_eq!(look(980), (Causes::NONE, 1));
        gauge.beat(ms(1000));
        assert_eq!(look(1000), (Causes::NONE, 2));
        assert_eq!(look(1020), (Causes::NONE, 3));
        assert_eq!(look(1021), (Causes::OVERRUN, 4));
        assert_eq!(look(1051), (Causes::OVERRUN.with(Causes::VITAL), 4));
        gauge.beat(ms(1052));
        assert_eq!(look(1053), (Causes::NONE, 5));
    }

    #[test]
    fn after_a_freeze_everybody_gets_the_time_it_had_before() {
        let (mut watchdog, _writer) = watchdog();
        watchdog.vital[0].gauge.beat(ms(1000));
        watchdog.look(ms(1000));
        // A second in which nobody ran, the watchdog included.
        watchdog.look(ms(2000));
        assert_eq!(watchdog.channel.watched(), Causes::NONE);
        watchdog.look(ms(2040));
        watchdog.look(ms(2051));
        let both = Causes::OVERRUN.with(Causes::VITAL);
        assert_eq!(watchdog.channel.watched(), both, "but it did not come back");
    }

    #[test]
    fn commands_that_are_stale_or_no_numbers_stand() {
        let (mut watchdog, mut writer) = watchdog();
        let mut words = [0.0; WORDS_MAX];
        writer.write(ms(1000), &words);
        watchdog.look(ms(1100));
        assert_eq!(watchdog.channel.watched(), Causes::NONE);
        watchdog.look(ms(1101));
        assert_eq!(watchdog.channel.watched(), Causes::STALE);
        for bad in [f64::NAN, f64::INFINITY, 2.5] {
            words[0] = bad;
            writer.write(ms(2000), &words);
            watchdog.look(ms(2000));
            assert_eq!(watchdog.channel.watched(), Causes::UNSOUND);
        }
        words[0] = 0.1;
        writer.write(Time(u64::MAX), &words);
        watchdog.look(ms(2000));
        assert_eq!(
            watchdog.channel.watched(),
            Causes::STALE,
            "a stamp from the future is stale"
        );
    }
}
