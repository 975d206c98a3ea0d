//! The halt gate: the last thing between commands and actuators. It starts closed and halt wins.
//!
//! ```text
//!            every vital layer beats, every command fresh and sound, nothing latched
//!   Closed ────────────────────────────────────────────────────────────────────────► Open
//!      ▲                                                                               │
//!      └──────────────── any cause ────────────────────────────────────────────────────┘
//!   a reflex of level 0 closes it for forward motion only: the robot may still turn away
//! ```
//! Must never allocate, wait, or depend on anything a tap can reach: causes come from stamps, beat counts and
//! the halt channel. Transient causes end with their cause; latched ones end by a reset (spec: two channels
//! join sensing to action, Brooks 1991 §4.2).

use ipc::clock::{Span, Time};

/// Why a body is halted. A set: several causes may hold at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Causes(pub u64);

/// Every cause, with the name that reports show.
const NAMES: [(Causes, &str); CAUSES] = [
    (Causes::START, "start"),
    (Causes::REFLEX, "reflex"),
    (Causes::STALE, "stale command"),
    (Causes::UNSOUND, "unsound command"),
    (Causes::VITAL, "vital layer late"),
    (Causes::OVERRUN, "overrun"),
    (Causes::EMERGENCY, "emergency stop"),
    (Causes::SHUTDOWN, "shutdown"),
    (Causes::BODY, "body lost"),
    (Causes::WATCHDOG, "watchdog late"),
    (Causes::MEMORY, "shared memory cut"),
    (Causes::PANIC, "panic"),
];

/// How many causes there are.
pub const CAUSES: usize = 12;

impl Causes {
    /// Nothing: the gate is open.
    pub const NONE: Causes = Causes(0);
    /// Not every vital layer has beaten, not every command has come yet.
    pub const START: Causes = Causes(1);
    /// A reflex of level 0: forward motion only.
    pub const REFLEX: Causes = Causes(2);
    /// A command is too old.
    pub const STALE: Causes = Causes(4);
    /// A command was not a number or out of range.
    pub const UNSOUND: Causes = Causes(8);
    /// A vital layer missed its beats. Latched.
    pub const VITAL: Causes = Causes(16);
    /// A layer whose policy is to halt ran over its period. Latched.
    pub const OVERRUN: Causes = Causes(32);
    /// Somebody pressed the emergency stop. Latched.
    pub const EMERGENCY: Causes = Causes(64);
    /// The daemon is leaving. Latched, and never reset.
    pub const SHUTDOWN: Causes = Causes(128);

    /// The world behind the motor unit does not answer: its process is dead, frozen, or hangs.
    pub const BODY: Causes = Causes(256);
    /// The watchdog missed its beats, so that nobody looks after the others. Latched.
    pub const WATCHDOG: Causes = Causes(512);
    /// Somebody cut a shared-memory segment short under this process. Latched, and never reset.
    pub const MEMORY: Causes = Causes(1024);
    /// A thread of this process panicked. Latched, and never reset.
    pub const PANIC: Causes = Causes(2048);

    /// Causes that stay until reset.
    pub const LATCHED: Causes = Causes(16 | 32 | 64 | 128 | 512 | 1024 | 2048);

    /// Causes that no reset ends: the process has to go.
    pub const FINAL: Causes = Causes(128 | 1024 | 2048);

    /// Every cause with its name, in the order of its bit.
    pub fn named() -> impl Iterator<Item = (Causes, &'static str)> {
        NAMES.into_iter()
    }

    /// Both sets together.
    #[must_use]
    pub const fn with(self, other: Causes) -> Causes {
        Causes(self.0 | other.0)
    }

    /// This set without the other.
    #[must_use]
    pub const fn without(self, other: Causes) -> Causes {
        Causes(self.0 & !other.0)
    }

    /// Whether any of `other` is in this set.
    pub const fn has(self, other: Causes) -> bool {
        self.0 & other.0 != 0
    }

    /// Those of `other` that are in this set.
    #[must_use]
    pub const fn and(self, other: Causes) -> Causes {
        Causes(self.0 & other.0)
    }

    /// Each cause of this set, with its place among all causes.
    pub fn each(self) -> impl Iterator<Item = (usize, Causes)> {
        let all = NAMES.iter().enumerate();
        all.filter(move |(_, (cause, _))| self.has(*cause))
            .map(|(i, (cause, _))| (i, *cause))
    }

    /// Every cause there is.
    pub fn all() -> Causes {
        Causes((1 << CAUSES) - 1)
    }

    /// The causes by name.
    pub fn names(self) -> Vec<&'static str> {
        NAMES
            .iter()
            .filter(|(cause, _)| self.has(*cause))
            .map(|(_, name)| *name)
            .collect()
    }
}

/// How far the actuators may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// As commanded.
    Open,
    /// As commanded, but not forward.
    NoForward,
    /// Not at all.
    Closed,
}

/// What the gate looks at in one beat of the motor unit.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The time of the beat.
    pub now: Time,
    /// Stamp of the oldest motion command; `None` if one never came.
    pub oldest_command: Option<Time>,
    /// Whether a command was refused as unsound since the last beat.
    pub unsound: bool,
    /// Stamp of the newest reflex message.
    pub reflex: Option<Time>,
    /// Whether every vital layer has begun to beat.
    pub vital_began: bool,
    /// Causes that the motor unit and the watchdog see standing now: a late vital layer, a lost body.
    pub standing: Causes,
    /// Causes that others latch: overrun, emergency stop, shutdown.
    pub latched: Causes,
    /// Whether a reset was asked for since the last beat.
    pub reset: bool,
}

/// The gate.
#[derive(Clone, Copy, Debug)]
pub struct Gate {
    stale: Span,
    hold: Span,
    began: bool,
    latched: Causes,
    unsound_at: Option<Time>,
}

impl Gate {
    /// A closed gate. Commands older than `stale` close it; a reflex holds for `hold`.
    pub fn new(stale: Span, hold: Span) -> Gate {
        Gate {
            stale,
            hold,
            began: false,
            latched: Causes::NONE,
            unsound_at: None,
        }
    }

    /// Decides one beat.
    pub fn decide(&mut self, seen: &Seen) -> (Causes, Passage) {
        let mut causes = Causes::NONE;
        let fresh = seen
            .oldest_command
            .is_some_and(|stamp| seen.now.since(stamp) <= self.stale);
        self.began |= fresh && seen.vital_began;
        if !self.began {
            causes = causes.with(Causes::START);
        } else if !fresh {
            causes = causes.with(Causes::STALE);
        }
        if seen.unsound {
            self.unsound_at = Some(seen.now);
        }
        if self.unsound_at.is_some_and(|at| seen.now.since(at) <= self.stale) {
            causes = causes.with(Causes::UNSOUND);
        }
        if seen.reflex.is_some_and(|stamp| seen.now.since(stamp) < self.hold) {
            causes = causes.with(Causes::REFLEX);
        }
        if seen.reset {
            self.latched = Causes::NONE;
        }
        self.latched = self.latched.with(seen.latched);
        if self.began {
            self.latched = self.latched.with(seen.standing.and(Causes::LATCHED));
        }
        let transient = seen.standing.without(Causes::LATCHED);
        causes = causes.with(self.latched).with(transient);
        (causes, Passage::for_causes(causes))
    }
}

impl Passage {
    /// What passes while the gate is closed for `causes`.
    pub const fn for_causes(causes: Causes) -> Passage {
        match causes {
            Causes::NONE => Passage::Open,
            Causes::REFLEX => Passage::NoForward,
            _ => Passage::Closed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(now_ms: u64) -> Seen {
        Seen {
            now: Time(now_ms * 1_000_000),
            oldest_command: Some(Time(now_ms * 1_000_000)),
            unsound: false,
            reflex: None,
            vital_began: true,
            standing: Causes::NONE,
            latched: Causes::NONE,
            reset: false,
        }
    }

    fn gate() -> Gate {
        Gate::new(Span::millis(100), Span::millis(60))
    }

    #[test]
    fn starts_closed_and_opens_when_level_0_beats() {
        let mut gate = gate();
        let quiet = Seen {
            oldest_command: None,
            ..seen(0)
        };
        assert_eq!(gate.decide(&quiet), (Causes::START, Passage::Closed));
        let unborn = Seen {
            vital_began: false,
            ..seen(1)
        };
        assert_eq!(gate.decide(&unborn), (Causes::START, Passage::Closed));
        assert_eq!(gate.decide(&seen(2)), (Causes::NONE, Passage::Open));
    }

    #[test]
    fn transient_causes_end_with_their_cause() {
        let mut gate = gate();
        gate.decide(&seen(0));
        let old = Seen {
            oldest_command: Some(Time(0)),
            ..seen(101)
        };
        assert_eq!(gate.decide(&old), (Causes::STALE, Passage::Closed));
        assert_eq!(gate.decide(&seen(102)).1, Passage::Open);
        assert_eq!(
            gate.decide(&Seen {
                unsound: true,
                ..seen(103)
            }),
            (Causes::UNSOUND, Passage::Closed)
        );
        assert_eq!(gate.decide(&seen(203)).1, Passage::Closed);
        assert_eq!(gate.decide(&seen(204)).1, Passage::Open);
    }

    #[test]
    fn a_reflex_stops_forward_motion_while_it_holds() {
        let mut gate = gate();
        gate.decide(&seen(0));
        let reflex = |now| Seen {
            reflex: Some(Time(10_000_000)),
            ..seen(now)
        };
        assert_eq!(gate.decide(&reflex(10)), (Causes::REFLEX, Passage::NoForward));
        assert_eq!(gate.decide(&reflex(69)).1, Passage::NoForward);
        assert_eq!(gate.decide(&reflex(70)).1, Passage::Open);
    }

    #[test]
    fn latched_causes_stay_until_reset_and_reset_does_not_outvote_a_standing_cause() {
        for cause in [Causes::EMERGENCY, Causes::OVERRUN] {
            let mut gate = gate();
            gate.decide(&seen(0));
            gate.decide(&Seen {
                latched: cause,
                ..seen(1)
            });
            assert_eq!(gate.decide(&seen(2)), (cause, Passage::Closed));
            let standing = Seen {
                reset: true,
                latched: cause,
                ..seen(3)
            };
            assert_eq!(gate.decide(&standing).1, Passage::Closed);
            assert_eq!(
                gate.decide(&Seen {
                    reset: true,
                    ..seen(4)
                })
                .1,
                Passage::Open
            );
        }
        let mut gate = gate();
        gate.decide(&seen(0));
        gate.decide(&Seen {
            standing: Causes::VITAL,
            ..seen(1)
        });
        assert_eq!(gate.decide(&seen(2)), (Causes::VITAL, Passage::Closed));
    }

    #[test]
    fn a_lost_body_halts_until_it_is_back() {
        let mut gate = gate();
        gate.decide(&seen(0));
        let lost = Seen {
            standing: Causes::BODY,
            ..seen(1)
        };
        assert_eq!(gate.decide(&lost), (Causes::BODY, Passage::Closed));
        assert_eq!(gate.decide(&seen(2)), (Causes::NONE, Passage::Open));
    }

    #[test]
    fn every_cause_has_one_name_and_one_place() {
        let places: Vec<usize> = Causes::all().each().map(|(place, _)| place).collect();
        assert_eq!(places, (0..CAUSES).collect::<Vec<_>>());
        assert!(NAMES.iter().enumerate().all(|(i, (cause, _))| cause.0 == 1 << i));
    }
}

#[cfg(test)]
#[path = "gate_every_case.rs"]
mod every_case;
