//! The flow of one tap: how many messages a layer process writes, and how many of them are none.
//!
//! Must never trust a number that a foreign process wrote: it may jump, or run backwards.

use ipc::clock::{Span, Time};
use ipc::wire::{Reader, TapGauge};

/// Length of the window in which messages are counted.
const WINDOW: Span = Span::secs(1);

/// How often garbage is worth a word.
const GARBAGE_SAID: Span = Span::secs(10);

/// What was seen of a tap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow {
    /// Messages when the window began, and when it did.
    first: u64,
    since: Time,
    /// Garbage when it was last spoken of, and when it was.
    faults: u64,
    said: Option<Time>,
}

impl Flow {
    pub(crate) fn new(reader: &Reader, now: Time) -> Flow {
        Flow {
            first: reader.number().unwrap_or(0),
            since: now,
            faults: 0,
            said: None,
        }
    }

    /// Whether more than `most` messages came within a second, or the count ran backwards. `number` is none
    /// while a message is being written.
    pub(crate) fn flood(&mut self, number: Option<u64>, most: u32, now: Time) -> Option<String> {
        let number = number?;
        if number < self.first {
            return Some(format!("its count ran back from {} to {number}", self.first));
        }
        let messages = number - self.first;
        let passed = now.since(self.since);
        // A layer of just that rate, seen a beat early and a beat late.
        let allowed = u64::from(most) + u64::from(most) / 10 + 2;
        if messages > allowed {
            return Some(format!(
                "{messages} messages in {:.1} s, {most} a second are allowed",
                passed.seconds()
            ));
        }
        if passed >= WINDOW {
            (self.first, self.since) = (number, now);
        }
        None
    }

    /// Whether messages came that were none, said at most every ten seconds.
    pub(crate) fn garbage(&mut self, gauge: &TapGauge, now: Time) -> Option<String> {
        let faults = gauge.counts().faults;
        let new = faults - self.faults;
        if new == 0 || self.said.is_some_and(|said| now.since(said) < GARBAGE_SAID) {
            return None;
        }
        (self.faults, self.said) = (faults, Some(now));
        Some(format!(
            "{new} messages that were none (not a number, out of range, stamped wrongly)"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow() -> Flow {
        Flow {
            first: 0,
            since: Time::ZERO,
            faults: 0,
            said: None,
        }
    }

    #[test]
    fn the_rate_that_is_allowed_passes_for_ever_and_twice_that_does_not() {
        let mut steady = flow();
        for tenth in 1..1000 {
            let now = Time(tenth * 100_000_000);
            assert_eq!(steady.flood(Some(tenth * 10), 100, now), None, "at {tenth}");
        }
        let mut double = flow();
        let caught = (1..20).find(|tenth| {
            double
                .flood(Some(tenth * 20), 100, Time(tenth * 100_000_000))
                .is_some()
        });
        assert_eq!(caught, Some(6));
    }

    #[test]
    fn a_count_that_jumps_or_runs_back_is_a_breach() {
        assert!(flow().flood(Some(u64::MAX / 2), 100, Time(1)).is_some());
        let mut back = flow();
        assert_eq!(back.flood(Some(50), 100, Time(2_000_000_000)), None);
        assert!(back.flood(Some(49), 100, Time(2_100_000_000)).is_some());
        assert_eq!(back.flood(None, 100, Time(2_100_000_000)), None, "being written");
    }
}
