//! Deadline arithmetic: which beat is due when, which ones were missed, and what the policy makes of it.
//!
//! Must never read a clock or keep anything but numbers: what a thread does about time is decided here and
//! can be tried for every case there is.
//!
//! ```text
//!   first      due(1)     due(2)     due(3)          a beat: released at due(n), over at `ended`
//!     ├──────────┼──────────┼──────────┼───►         deadline of beat n: due(n+1)
//!        ▲ended: met   ▲ended: beat 0 missed its deadline; beat 1 is skipped, or made up for
//! ```
//! *Beat n* is due at `first + n · period`; its deadline is when the next one is due. *Missed*: a beat that
//! ended after its deadline, for whatever reason; a late release counts. *Overrun*: a beat whose own run took
//! longer than a period; that is the layer's own fault. *Skipped*: a beat that never ran. *Owed*: beats due
//! that have neither run nor been skipped.
//!
//! The identity that always holds: `(next due − first) / period = beats + skipped`.

use ipc::clock::{Span, Time};
use ipc::wiring::creature::Overrun;

/// Most beats that are made up for in a row under [`Overrun::CatchUp`]; what is owed beyond is skipped. A thread
/// that owes always never sleeps, and the host ends real-time threads that don't: sixteen beats of 10 ms are
/// well within the half second that it grants.
pub const OWED_MAX: u64 = 16;

/// What is to be done after a beat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// The beat ended after its deadline.
    pub missed: bool,
    /// The beat's own run took longer than a period.
    pub overrun: bool,
    /// So many beats are left out now.
    pub skip: u64,
    /// The body is to halt.
    pub halt: bool,
}

/// Where a thread stands in its grid of beats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    first: Time,
    period: Span,
    policy: Overrun,
    /// When the next beat is due; moved by addition alone, so that the identity is no tautology.
    due: Time,
    beats: u64,
    skipped: u64,
}

impl Pace {
    /// The first beat is due at `first`, the others every `period`.
    ///
    /// # Panics
    /// When the period is zero.
    pub fn new(first: Time, period: Span, policy: Overrun) -> Pace {
        assert!(period > Span::ZERO, "a period is longer than zero");
        Pace {
            first,
            period,
            policy,
            due: first,
            beats: 0,
            skipped: 0,
        }
    }

    /// When the next beat is due.
    pub fn due(&self) -> Time {
        self.due
    }

    /// Beats that ran, and beats that were skipped.
    pub fn counts(&self) -> (u64, u64) {
        (self.beats, self.skipped)
    }

    /// How many beats fell due before `t` and have neither run nor been skipped.
    pub fn owed(&self, t: Time) -> u64 {
        t.since(self.due).0.div_ceil(self.period.0)
    }

    /// Whether the identity holds.
    pub fn sound(&self) -> bool {
        let steps = self.beats.checked_add(self.skipped);
        let grid = steps.and_then(|n| n.checked_mul(self.period.0));
        grid == Some(self.due.since(self.first).0)
    }

    /// The beat that was due has run from `woke` to `ended`: moves on to the next one.
    pub fn after(&mut self, woke: Time, ended: Time) -> Verdict {
        self.beats += 1;
        self.due = self.due + self.period;
        let owed = self.owed(ended);
        let missed = owed > 0;
        let skip = match self.policy {
            Overrun::Skip | Overrun::Halt => owed,
            Overrun::CatchUp => owed.saturating_sub(OWED_MAX),
        };
        self.skipped += skip;
        self.due = self.due + Span(skip * self.period.0);
        Verdict {
            missed,
            overrun: ended.since(woke) > self.period,
            skip,
            halt: missed && self.policy == Overrun::Halt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slow way: walks the grid point by point.
    fn grid_points(first: u64, period: u64, from: u64, before: u64) -> u64 {
        (0..)
            .map(|n| first + n * period)
            .take_while(|t| *t < before)
            .filter(|t| *t >= from)
            .count() as u64
    }

    /// Tries every sequence of `depth` beats, each late by 0.. and long by 0.. up to beyond three periods.
    fn every_case(pace: Pace, clock: u64, depth: u32, tried: &mut u64) {
        if depth == 0 {
            return;
        }
        let period = pace.period.0;
        for late in 0..=2 * period + 1 {
            for long in 0..=3 * period + 1 {
                let due = pace.due().0;
                let woke = clock.max(due) + late;
                let ended = woke + long;
                let mut next = pace;
                let verdict = next.after(Time(woke), Time(ended));
                check(&pace, &next, verdict, woke, ended);
                *tried += 1;
                every_case(next, ended, depth - 1, tried);
            }
        }
    }

    fn check(before: &Pace, after: &Pace, verdict: Verdict, woke: u64, ended: u64) {
        let (period, due) = (before.period.0, before.due().0);
        assert!(after.sound(), "the identity: {after:?}");
        assert_eq!(verdict.missed, ended > due + period, "missed: {before:?} {ended}");
        assert_eq!(verdict.overrun, ended - woke > period);
        let owed = grid_points(before.first.0, period, due + period, ended);
        assert_eq!(after.counts().0, before.counts().0 + 1);
        assert_eq!(after.counts().1, before.counts().1 + verdict.skip);
        match before.policy {
            Overrun::CatchUp => {
                assert_eq!(verdict.skip, owed.saturating_sub(OWED_MAX));
                assert_eq!(after.owed(Time(ended)), owed.min(OWED_MAX));
                assert!(!verdict.halt);
            }
            policy => {
                assert_eq!(verdict.skip, owed);
                assert!(
                    after.due() >= Time(ended),
                    "never a burst: the next beat is not in the past"
                );
                assert!(
                    after.due().0 < ended.max(due + 1) + period,
                    "nor is one left out for nothing"
                );
                assert_eq!(verdict.halt, policy == Overrun::Halt && verdict.missed);
            }
        }
    }

    #[test]
    fn the_identity_holds_after_every_sequence_of_late_and_long_beats() {
        let mut tried = 0;
        for policy in [Overrun::Skip, Overrun::CatchUp, Overrun::Halt] {
            for (first, period) in [(0, 1), (3, 2), (7, 3)] {
                let pace = Pace::new(Time(first), Span(period), policy);
                every_case(pace, 0, 3, &mut tried);
            }
        }
        assert!(tried > 400_000, "{tried} cases");
    }

    #[test]
    fn what_is_owed_beyond_the_bound_is_skipped() {
        let mut pace = Pace::new(Time(0), Span(10), Overrun::CatchUp);
        let verdict = pace.after(Time(0), Time(1_000));
        assert_eq!(verdict.skip, 99 - OWED_MAX, "beats 1 to 99 fell due before 1000");
        let mut made_up = 0;
        while pace.due() < Time(1_000) {
            pace.after(Time(1_000), Time(1_000));
            made_up += 1;
        }
        assert_eq!(made_up, OWED_MAX);
        assert_eq!(pace.counts(), (1 + OWED_MAX, 99 - OWED_MAX));
        assert!(pace.sound());
    }

    #[test]
    fn a_beat_that_ends_exactly_at_its_deadline_met_it() {
        for policy in [Overrun::Skip, Overrun::CatchUp, Overrun::Halt] {
            let mut pace = Pace::new(Time(100), Span(10), policy);
            assert_eq!(pace.after(Time(100), Time(110)), Verdict::default());
            assert_eq!(pace.due(), Time(110));
            let late = pace.after(Time(119), Time(121));
            assert!(late.missed && !late.overrun, "a late release counts: {late:?}");
        }
    }

    #[test]
    fn ten_years_of_nanoseconds_do_not_overflow() {
        let mut pace = Pace::new(Time(1 << 60), Span::micros(10), Overrun::Skip);
        let end = Time((1 << 60) + 10 * 365 * 86_400 * 1_000_000_000);
        pace.after(end, end);
        assert!(pace.sound() && pace.due() >= end);
    }
}
