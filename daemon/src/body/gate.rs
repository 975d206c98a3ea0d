//! The body's own halt gate: the last defence, at the world's end of the link.
//!
//! ```text
//!            every motion command there, younger than the stale limit, finite and in range
//!   Closed ───────────────────────────────────────────────────────────────────────────────► Open
//!      ▲  (starts here)                                                                       │
//!      └──────────── one of them missing, stale, stamped in the future, or unsound ───────────┘
//! ```
//! Must never rely on the daemon being alive or sane: it looks at its own clock and at what is in the cells,
//! and a daemon that was killed, stopped or hangs only has to do nothing for it to close.

use ipc::clock::{Span, Time};
use ipc::wire::{Limits, Reading};

use crate::gate::Causes;

/// The gate.
#[derive(Clone, Copy, Debug)]
pub struct BodyGate {
    stale: Span,
    causes: Causes,
    closings: u32,
    began: bool,
}

impl BodyGate {
    /// A closed gate. Commands older than `stale` close it.
    pub fn new(stale: Span) -> BodyGate {
        BodyGate {
            stale,
            causes: Causes::START,
            closings: 0,
            began: false,
        }
    }

    /// Decides one turn. `now` was looked at after the commands were read, so that none of a sane daemon's
    /// is stamped later. `leaving` holds causes of the process's own.
    pub fn decide<'r>(
        &mut self,
        now: Time,
        commands: impl Iterator<Item = (Option<&'r Reading>, &'r Limits)>,
        leaving: Causes,
    ) -> Causes {
        let mut causes = leaving;
        for (reading, limits) in commands {
            let fresh = reading.is_some_and(|r| r.stamp <= now && now.since(r.stamp) <= self.stale);
            if !fresh {
                let cause = if self.began { Causes::STALE } else { Causes::START };
                causes = causes.with(cause);
            }
            let sound = reading.is_none_or(|r| limits.kind.accepts(&r.words, limits.low, limits.high));
            if !sound {
                causes = causes.with(Causes::UNSOUND);
            }
        }
        self.began |= causes == Causes::NONE;
        if self.causes == Causes::NONE && causes != Causes::NONE {
            self.closings = self.closings.saturating_add(1);
        }
        self.causes = causes;
        causes
    }

    /// Why it is closed; nothing when it is open.
    pub fn causes(&self) -> Causes {
        self.causes
    }

    /// How often it has closed.
    pub fn closings(&self) -> u32 {
        self.closings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ipc::message::{Kind, WORDS_MAX};

    const LIMITS: Limits = Limits {
        kind: Kind::Number,
        low: -2.0,
        high: 2.0,
    };

    fn reading(stamp_ms: u64, value: f64) -> Reading {
        let mut words = [0.0; WORDS_MAX];
        words[0] = value;
        Reading {
            number: 1,
            stamp: Time(stamp_ms * 1_000_000),
            words,
        }
    }

    fn decide(gate: &mut BodyGate, now_ms: u64, commands: [Option<Reading>; 2]) -> Causes {
        let pairs = commands.iter().map(|c| (c.as_ref(), &LIMITS));
        gate.decide(Time(now_ms * 1_000_000), pairs, Causes::NONE)
    }

    #[test]
    fn starts_closed_opens_with_all_commands_closes_when_one_goes_stale() {
        let mut gate = BodyGate::new(Span::millis(200));
        assert_eq!(gate.causes(), Causes::START);
        let one = Some(reading(10, 0.3));
        assert_eq!(decide(&mut gate, 10, [one, None]), Causes::START);
        assert_eq!(decide(&mut gate, 20, [one, one]), Causes::NONE);
        let fresh = Some(reading(210, 0.3));
        assert_eq!(decide(&mut gate, 210, [fresh, one]), Causes::NONE);
        assert_eq!(decide(&mut gate, 211, [fresh, one]), Causes::STALE);
        assert_eq!(gate.closings(), 1);
        assert_eq!(decide(&mut gate, 212, [fresh, fresh]), Causes::NONE);
    }

    #[test]
    fn what_is_no_number_out_of_range_or_from_the_future_closes_it() {
        let mut gate = BodyGate::new(Span::millis(200));
        let good = Some(reading(10, 0.0));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 2.1, -1e300] {
            assert_eq!(decide(&mut gate, 10, [good, good]), Causes::NONE);
            assert_eq!(
                decide(&mut gate, 10, [Some(reading(10, bad)), good]),
                Causes::UNSOUND
            );
        }
        let ahead = Some(reading(u64::MAX / 2_000_000, 0.0));
        assert_eq!(decide(&mut gate, 10, [ahead, good]), Causes::STALE);
    }
}
