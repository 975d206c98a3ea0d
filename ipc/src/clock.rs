//! Telling the time: the only module of the workspace that reads a clock.
//!
//! Must never be bypassed: whoever needs the time is handed a [`Clock`] or a [`Time`], so that the
//! virtual clock can stand in everywhere and a run repeats to the bit.
//!
//! [`Time`] is a moment, [`Span`] a length of time; both count whole nanoseconds. The real clock is
//! `CLOCK_MONOTONIC`, which every process of a host shares, so stamps of different processes compare.

use std::fmt;
use std::ops::{Add, Sub};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::{Deserialize, Serialize};

use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};

/// A moment on the monotonic clock of the executor, in nanoseconds since the clock's own zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(pub u64);

/// A length of time in nanoseconds; never negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Span(pub u64);

impl Time {
    /// The earliest moment.
    pub const ZERO: Time = Time(0);
    /// How long after `earlier` this moment is; zero if it is not after it.
    #[inline]
    pub fn since(self, earlier: Time) -> Span {
        Span(self.0.saturating_sub(earlier.0))
    }
    /// Seconds since the clock's zero.
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-9
    }
    /// The first moment from this one on that lies 0.3 ms after a full millisecond.
    ///
    /// Linux puts its tick at multiples of its own period, 1 to 10 ms, of this clock (since 6.5, `tick_init_jiffy_update`
    /// in kernel/time/tick-sched.c). Beats of whole milliseconds counted from here are never met by it; on a virtual
    /// machine it takes tens of microseconds from whom it meets.
    pub fn off_tick(self) -> Time {
        Time(300_000).on_grid(Span::millis(1), self)
    }
    /// The first moment of the grid of `period` through this one that is not before `now`: this one itself if it
    /// is still to come.
    ///
    /// # Panics
    /// When the period is zero.
    pub fn on_grid(self, period: Span, now: Time) -> Time {
        let missed = now.since(self).0.div_ceil(period.0);
        self + Span(missed * period.0)
    }
}

impl Span {
    /// No time at all.
    pub const ZERO: Span = Span(0);
    /// A span of whole nanoseconds.
    pub const fn nanos(n: u64) -> Span {
        Span(n)
    }
    /// A span of whole microseconds.
    pub const fn micros(n: u64) -> Span {
        Span(n * 1_000)
    }
    /// A span of whole milliseconds.
    pub const fn millis(n: u64) -> Span {
        Span(n * 1_000_000)
    }
    /// A span of whole seconds.
    pub const fn secs(n: u64) -> Span {
        Span(n * 1_000_000_000)
    }
    /// The span in seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-9
    }
    /// The span in milliseconds.
    pub fn as_millis_f64(self) -> f64 {
        self.0 as f64 * 1e-6
    }
    /// The span of a non-negative, finite number of seconds, rounded to the nanosecond.
    pub fn from_seconds(seconds: f64) -> Option<Span> {
        let nanos = (seconds * 1e9).round();
        (0.0..9.0e18).contains(&nanos).then_some(Span(nanos as u64))
    }
    /// Reads `"20ms"`, `"1.5s"`, `"50us"`, `"250ns"` or `"2min"`.
    ///
    /// # Errors
    /// A sentence saying what was expected, when the text is not a number with one of those units.
    pub fn parse(text: &str) -> Result<Span, String> {
        const EXPECTED: &str = "expected a time with a unit, such as \"20ms\", \"1.5s\" or \"50us\"";
        let split = text.find(|c: char| c.is_ascii_alphabetic()).ok_or(EXPECTED)?;
        let number: f64 = text[..split].trim().parse().map_err(|_| EXPECTED)?;
        let unit = match &text[split..] {
            "ns" => 1.0,
            "us" => 1e3,
            "ms" => 1e6,
            "s" => 1e9,
            "min" => 60e9,
            _ => return Err(EXPECTED.into()),
        };
        let nanos = (number * unit).round();
        if !(0.0..=9.0e17).contains(&nanos) {
            return Err("expected a time that is not negative and shorter than 28 years".into());
        }
        Ok(Span(nanos as u64))
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = self.0;
        match n {
            _ if n.is_multiple_of(1_000_000_000) => write!(f, "{}s", n / 1_000_000_000),
            _ if n.is_multiple_of(1_000_000) => write!(f, "{}ms", n / 1_000_000),
            _ if n.is_multiple_of(1_000) => write!(f, "{}us", n / 1_000),
            _ => write!(f, "{n}ns"),
        }
    }
}

impl Add<Span> for Time {
    type Output = Time;
    #[inline]
    fn add(self, span: Span) -> Time {
        Time(self.0.saturating_add(span.0))
    }
}

impl Sub<Span> for Time {
    type Output = Time;
    #[inline]
    fn sub(self, span: Span) -> Time {
        Time(self.0.saturating_sub(span.0))
    }
}

impl Add for Span {
    type Output = Span;
    #[inline]
    fn add(self, other: Span) -> Span {
        Span(self.0.saturating_add(other.0))
    }
}

/// Where the time comes from.
#[derive(Clone, Debug)]
pub enum Clock {
    /// `CLOCK_MONOTONIC` of the host (read through the vDSO: no system call).
    Real,
    /// A clock that stands still until somebody sets it.
    Virtual(VirtualClock),
}

/// A clock that is moved by hand; clones show the same time.
#[derive(Clone, Debug, Default)]
pub struct VirtualClock(Arc<AtomicU64>);

impl VirtualClock {
    /// Moves the clock to `time`.
    pub fn set(&self, time: Time) {
        // Relaxed: a virtual run is stepped in one thread; nothing is published through the clock.
        self.0.store(time.0, Ordering::Relaxed);
    }
}

impl Clock {
    /// The time now.
    pub fn now(&self) -> Time {
        match self {
            Clock::Real => monotonic(),
            Clock::Virtual(clock) => Time(clock.0.load(Ordering::Relaxed)),
        }
    }
}

/// The time now on the host's monotonic clock.
pub fn monotonic() -> Time {
    let t = clock_gettime(ClockId::Monotonic);
    Time(t.tv_sec as u64 * 1_000_000_000 + t.tv_nsec as u64)
}

/// Sleeps until `deadline` on the host's monotonic clock: one `clock_nanosleep` to an absolute time,
/// taken up again if a signal interrupts it.
pub fn sleep_until(deadline: Time) {
    let at = Timespec {
        tv_sec: (deadline.0 / 1_000_000_000) as i64,
        tv_nsec: (deadline.0 % 1_000_000_000) as i64,
    };
    while clock_nanosleep_absolute(ClockId::Monotonic, &at).is_err() {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_goes_on_from_where_it_is() {
        let (first, period) = (Time(5), Span(10));
        let on = [0, 5, 6, 15, 16, 25].map(|now| first.on_grid(period, Time(now)).0);
        assert_eq!(on, [5, 5, 15, 15, 25, 25]);
    }

    #[test]
    fn beats_keep_away_from_the_tick() {
        let ms = 1_000_000;
        let off = [0, 300_000, 300_001, 7 * ms, 8 * ms - 1].map(|t| Time(t).off_tick().0);
        assert_eq!(
            off,
            [300_000, 300_000, ms + 300_000, 7 * ms + 300_000, 8 * ms + 300_000]
        );
    }

    #[test]
    fn spans_read_what_they_write() {
        for span in [Span::nanos(7), Span::micros(50), Span::millis(20), Span::secs(3)] {
            assert_eq!(Span::parse(&span.to_string()), Ok(span));
        }
        assert_eq!(Span::parse("1.5s"), Ok(Span::millis(1500)));
        for bad in ["", "20", "ms", "-1ms", "1e30s", "3 parsecs", "NaNs"] {
            assert!(Span::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn virtual_clock_shows_what_was_set() {
        let clock = VirtualClock::default();
        let shown = Clock::Virtual(clock.clone());
        clock.set(Time(42));
        assert_eq!(shown.now(), Time(42));
    }
}
