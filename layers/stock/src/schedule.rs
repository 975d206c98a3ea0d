//! A schedule: which message of a list of times and a period is due.
//!
//! ```text
//!  first beat = 0 ── at[0] ── at[1] ── … ── at[last] ── +every ── +every ── …
//! ```
//! Must never drift: a late beat moves nothing that comes after it. Of several messages due at one beat the
//! newest counts, the others are lost as they would be on any wire.

use ipc::clock::{Span, Time};

/// Times counted from the first beat after the start or a reset.
#[derive(Debug)]
pub(crate) struct Schedule {
    at: Box<[Span]>,
    every: Span,
    begun: Option<Time>,
    sent: u64,
}

impl Schedule {
    /// The times `at` in any order; the last of them is repeated `every` so often unless that is zero. A period
    /// without times begins at once.
    pub(crate) fn new(at: &[Span], every: Span) -> Schedule {
        let mut at = at.to_vec();
        if at.is_empty() && every > Span::ZERO {
            at.push(Span::ZERO);
        }
        at.sort_unstable();
        Schedule {
            at: at.into(),
            every,
            begun: None,
            sent: 0,
        }
    }

    /// The number, counted from 0, of the newest message that is due at `now` and was not due before.
    pub(crate) fn due(&mut self, now: Time) -> Option<u64> {
        let begun = *self.begun.get_or_insert(now);
        let due = self.due_after(now.since(begun));
        if due <= self.sent {
            return None;
        }
        self.sent = due;
        Some(due - 1)
    }

    /// How many messages are due after `elapsed`.
    fn due_after(&self, elapsed: Span) -> u64 {
        let listed = self.at.partition_point(|at| *at <= elapsed) as u64;
        match self.at.last() {
            Some(last) if *last <= elapsed && self.every > Span::ZERO => {
                listed + (elapsed.0 - last.0) / self.every.0
            }
            _ => listed,
        }
    }

    /// Begins anew at the next beat.
    pub(crate) fn reset(&mut self) {
        self.begun = None;
        self.sent = 0;
    }

    /// The name of the state.
    pub(crate) fn state(&self) -> &'static str {
        if self.every > Span::ZERO || self.sent < self.at.len() as u64 {
            "sending"
        } else {
            "done"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Time {
        Time(5_000_000_000) + Span::millis(ms)
    }

    #[test]
    fn messages_are_due_at_their_times_and_then_periodically() {
        let mut schedule = Schedule::new(&[Span::millis(7), Span::millis(2)], Span::millis(10));
        let due: Vec<_> = (0..40)
            .filter_map(|ms| schedule.due(at(ms)).map(|n| (ms, n)))
            .collect();
        assert_eq!(due, [(2, 0), (7, 1), (17, 2), (27, 3), (37, 4)]);
    }

    #[test]
    fn a_late_beat_loses_messages_but_not_the_grid() {
        let mut schedule = Schedule::new(&[], Span::millis(10));
        assert_eq!(schedule.due(at(0)), Some(0));
        assert_eq!(schedule.due(at(35)), Some(3), "10 and 20 are lost");
        assert_eq!(schedule.due(at(39)), None);
        assert_eq!(schedule.due(at(40)), Some(4));
    }

    #[test]
    fn a_period_of_a_nanosecond_is_no_endless_loop() {
        let mut schedule = Schedule::new(&[], Span::nanos(1));
        assert_eq!(schedule.due(Time(1)), Some(0));
        assert_eq!(schedule.due(Time(u64::MAX)), Some(u64::MAX - 1));
    }

    #[test]
    fn an_empty_schedule_sends_nothing() {
        let mut schedule = Schedule::new(&[], Span::ZERO);
        assert_eq!((schedule.due(at(0)), schedule.due(at(9))), (None, None));
        assert_eq!(schedule.state(), "done");
    }
}
