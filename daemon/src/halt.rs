//! The halt channel: how others close the gate, and how all can see why it is closed, since when, how often.
//!
//! ```text
//!   operator, page, executor ── halt(cause): latched until reset ──┐
//!   watchdog ────────────────── watch(causes that stand now) ──────┼──► gate, in the motor unit ── show ──► all
//!   operator ────────────────── reset: refused while a cause stands┘
//! ```
//! Must never be reachable by a tap, and never wait: atomics throughout.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ipc::clock::Time;

use crate::executor::gauge::BeatGauge;
use crate::gate::{CAUSES, Causes};

/// The halt channel. Every access is relaxed: each bit and number is a message of its own.
#[derive(Debug)]
pub struct HaltChannel {
    /// The watchdog's beats: the motor unit looks after the one who looks after all others.
    pub watchdog: Arc<BeatGauge>,
    /// Causes latched by others; bits of [`Causes`].
    latched: AtomicU64,
    /// Causes that the watchdog sees standing.
    watched: AtomicU64,
    /// Number of resets asked for.
    resets: AtomicU64,
    /// What the gate decided last.
    decided: AtomicU64,
    /// When that last changed.
    since: AtomicU64,
    /// How often each cause began, and when last.
    records: [Record; CAUSES],
}

#[derive(Debug, Default)]
struct Record {
    count: AtomicU64,
    began: AtomicU64,
}

/// What was counted of one cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauseCount {
    /// The cause.
    pub cause: Causes,
    /// How often it began.
    pub count: u64,
    /// When it last began.
    pub began: Time,
}

impl Default for HaltChannel {
    /// Nothing is latched; the gate has not opened yet.
    fn default() -> Self {
        let channel = HaltChannel {
            watchdog: Arc::default(),
            latched: AtomicU64::new(0),
            watched: AtomicU64::new(0),
            resets: AtomicU64::new(0),
            decided: AtomicU64::new(Causes::START.0),
            since: AtomicU64::new(0),
            records: Default::default(),
        };
        channel.records[0].count.store(1, Ordering::Relaxed);
        channel
    }
}

impl HaltChannel {
    /// Closes the gate for `cause` until reset.
    pub fn halt(&self, cause: Causes) {
        self.latched.fetch_or(cause.0, Ordering::Relaxed);
    }

    /// Says what the watchdog sees standing now.
    pub fn watch(&self, standing: Causes) {
        self.watched.store(standing.0, Ordering::Relaxed);
    }

    /// What the watchdog saw standing when it last looked.
    pub fn watched(&self) -> Causes {
        Causes(self.watched.load(Ordering::Relaxed))
    }

    /// What others have latched.
    pub fn latched(&self) -> Causes {
        Causes(self.latched.load(Ordering::Relaxed))
    }

    /// Ends what is latched.
    ///
    /// # Errors
    /// When a latched cause still stands, with what to do; nothing is ended then.
    pub fn reset(&self) -> Result<(), String> {
        let now = self.latched().with(self.decided().0);
        if now.has(Causes::SHUTDOWN) {
            return Err("the daemon is shutting down; start it again to go on".into());
        }
        if now.has(Causes::MEMORY) {
            return Err("a shared-memory segment was cut short; the daemon leaves, start it again".into());
        }
        if now.has(Causes::PANIC) {
            return Err("a thread of the daemon panicked; the daemon leaves, start it again".into());
        }
        let standing = self.watched().and(Causes::LATCHED);
        if standing != Causes::NONE {
            let names = standing.names().join(", ");
            return Err(format!(
                "the cause still stands: {names}; mend it, then reset again"
            ));
        }
        // Only what was seen: an emergency stop of this very moment stays.
        self.latched.fetch_and(!now.0, Ordering::Relaxed);
        self.resets.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    /// Whether a reset was asked for since the caller's last look.
    pub(crate) fn reset_asked(&self, seen: &mut u64) -> bool {
        let resets = self.resets.load(Ordering::Relaxed);
        let asked = resets != *seen;
        *seen = resets;
        asked
    }

    /// Shows what the gate decided. Only the motor unit calls this.
    pub(crate) fn show(&self, causes: Causes, now: Time) {
        let before = Causes(self.decided.load(Ordering::Relaxed));
        if before == causes && self.since.load(Ordering::Relaxed) != 0 {
            return;
        }
        for (place, _) in causes.without(before).each() {
            let record = &self.records[place];
            record.began.store(now.0, Ordering::Relaxed);
            let count = record.count.load(Ordering::Relaxed);
            record.count.store(count + 1, Ordering::Relaxed);
        }
        self.decided.store(causes.0, Ordering::Relaxed);
        self.since.store(now.0.max(1), Ordering::Relaxed);
    }

    /// The causes for which the gate is closed, and since when.
    pub fn decided(&self) -> (Causes, Time) {
        (
            Causes(self.decided.load(Ordering::Relaxed)),
            Time(self.since.load(Ordering::Relaxed)),
        )
    }

    /// What was counted of each cause that ever was.
    pub fn counts(&self) -> Vec<CauseCount> {
        let count = |(place, cause): (usize, Causes)| CauseCount {
            cause,
            count: self.records[place].count.load(Ordering::Relaxed),
            began: Time(self.records[place].began.load(Ordering::Relaxed)),
        };
        let all = Causes::all().each().map(count);
        all.filter(|c| c.count > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reset_is_refused_while_its_cause_stands_and_ends_nothing_then() {
        let channel = HaltChannel::default();
        channel.halt(Causes::EMERGENCY);
        channel.watch(Causes::VITAL);
        let refusal = channel.reset().expect_err("the cause stands");
        assert!(refusal.contains("vital layer late"), "{refusal}");
        assert_eq!(channel.latched(), Causes::EMERGENCY);
        channel.watch(Causes::NONE);
        let mut seen = 0;
        assert!(!channel.reset_asked(&mut seen));
        channel.reset().expect("nothing stands");
        assert!(channel.reset_asked(&mut seen) && !channel.reset_asked(&mut seen));
        assert_eq!(channel.latched(), Causes::NONE);
    }

    #[test]
    fn a_transient_cause_does_not_keep_a_reset_back() {
        let channel = HaltChannel::default();
        channel.halt(Causes::EMERGENCY);
        channel.watch(Causes::STALE);
        assert_eq!(channel.reset(), Ok(()));
    }

    #[test]
    fn nothing_resets_a_daemon_that_has_to_go() {
        for cause in [Causes::SHUTDOWN, Causes::MEMORY, Causes::PANIC] {
            let channel = HaltChannel::default();
            channel.show(cause, Time(1));
            assert!(channel.reset().is_err());
        }
    }

    #[test]
    fn causes_are_counted_and_timed_when_they_begin() {
        let channel = HaltChannel::default();
        channel.show(Causes::START, Time(5));
        channel.show(Causes::NONE, Time(10));
        channel.show(Causes::STALE, Time(20));
        channel.show(Causes::STALE.with(Causes::BODY), Time(30));
        channel.show(Causes::NONE, Time(40));
        channel.show(Causes::STALE, Time(50));
        let counts = channel.counts();
        let of = |cause| counts.iter().find(|c| c.cause == cause).copied();
        let counted = |cause, count, began| {
            Some(CauseCount {
                cause,
                count,
                began: Time(began),
            })
        };
        assert_eq!(of(Causes::STALE), counted(Causes::STALE, 2, 50));
        assert_eq!(of(Causes::BODY), counted(Causes::BODY, 1, 30));
        assert_eq!(of(Causes::START).map(|c| c.count), Some(1));
        assert_eq!(of(Causes::VITAL), None);
        assert_eq!(channel.decided(), (Causes::STALE, Time(50)));
    }
}
