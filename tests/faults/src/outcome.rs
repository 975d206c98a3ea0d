//! Outcome: what came of one injection, or of several in one life of the daemon, and whether that is as specified.
//!
//! Must never excuse anything but a host that was seen to hold real-time threads up.

use ipc::clock::Span;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Lateness of a real-time thread from which on the host may be to blame for a halt: one such gap and a period
/// or two of the creature's own make the 50 ms that the watchdog takes for a fault.
pub(crate) const HOST_LATE: Span = Span::millis(15);

/// What the specification says of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Expected {
    /// The body halts.
    Halt,
    /// The creature goes on without a halt.
    GoesOn,
}

/// What came of a trial.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Outcome {
    /// How often the fault was injected.
    pub(crate) injections: u64,
    /// From each fault that was to halt the actuators to their halt.
    pub(crate) halts: Vec<Span>,
    /// Faults that were to halt them and did not.
    pub(crate) missed: u64,
    /// How long a halt may take.
    pub(crate) bound: Option<Span>,
    /// The watchdog's or the body's period, in which it is counted.
    pub(crate) period: Option<Span>,
    /// From the order to start again to a body that is free, where something was started again.
    pub(crate) restart: Option<Span>,
    /// Contacts that the robot caused.
    pub(crate) contacts: u64,
    /// Allocations on real-time threads.
    pub(crate) allocations: u64,
    /// Longest time that the host held up a real-time thread which only looks on.
    pub(crate) host_late: Span,
    /// Halts that the host caused, not the fault.
    pub(crate) host_halts: u64,
    /// What is not as specified.
    pub(crate) broken: Vec<String>,
    /// Why it was not tried.
    pub(crate) skipped: Option<String>,
}

impl Outcome {
    /// Notes what is not as specified, unless it holds.
    pub(crate) fn expect(&mut self, holds: bool, otherwise: impl FnOnce() -> String) {
        if !holds {
            self.broken.push(otherwise());
        }
    }

    /// Takes in what the daemon's status says of safety and of its real-time threads.
    pub(crate) fn inspect(&mut self, status: &Value) {
        let contacts = status["contacts"]["caused"].as_u64();
        let allocations = status["real_time_allocations"].as_u64();
        self.expect(contacts.is_some() && allocations.is_some(), || {
            "the status names no contacts or allocations".into()
        });
        self.contacts = self.contacts.max(contacts.unwrap_or(0));
        self.allocations = self.allocations.max(allocations.unwrap_or(0));
        for layer in status["layers"].as_array().into_iter().flatten() {
            let faults = layer["identity_faults"].as_u64().unwrap_or(0);
            self.expect(faults == 0, || format!("{}: beats do not add up", layer["name"]));
        }
    }

    /// Judges how often other causes than a reflex began between two statuses: a fault that nobody may halt
    /// for must not have halted.
    pub(crate) fn expect_no_halt(&mut self, before: &Value, after: &Value) {
        let (was, is) = (halts(before), halts(after));
        if is == was {
            return;
        }
        let late = self.host_late.max(latest(after));
        if late > HOST_LATE {
            self.host_halts += is.saturating_sub(was);
        } else {
            let counts = &after["halt"]["counts"];
            self.broken.push(format!("the body was halted: {counts}"));
        }
    }

    /// Notes that the actuators halted so long after a fault, or not at all; the host held everybody up by `late`
    /// meanwhile.
    pub(crate) fn halted(&mut self, halted: Option<Span>, bound: Span, late: Span) {
        self.bound = Some(bound);
        self.host_late = self.host_late.max(late);
        let Some(halted) = halted else {
            self.missed += 1;
            self.broken.push("MISSED: the body was not halted".into());
            return;
        };
        self.halts.push(halted);
        // What the host took from everybody, it took from the halt.
        self.expect(halted.0 <= bound.0 + late.0, || {
            format!("halted after {halted}, bound {bound}, the host late by {late}")
        });
    }

    /// How many injections were not as specified, as far as that can be told apart.
    pub(crate) fn not_as_specified(&self) -> u64 {
        (self.broken.len() as u64).min(self.injections.max(1))
    }

    /// Judges all of it, once it is over.
    pub(crate) fn judge(&mut self, expected: Expected) {
        let (seen, injections) = (self.halts.len() as u64 + self.missed, self.injections);
        self.expect(expected == Expected::GoesOn || seen == injections, || {
            format!("{injections} faults, {seen} looks at what came of them")
        });
        let contacts = self.contacts;
        self.expect(contacts == 0, || {
            format!("{contacts} contacts caused by the robot")
        });
        let allocations = self.allocations;
        self.expect(allocations == 0, || {
            format!("{allocations} allocations on real-time threads")
        });
    }
}

/// How often causes other than a reflex and the start began.
pub(crate) fn halts(status: &Value) -> u64 {
    let counts = status["halt"]["counts"].as_array().into_iter().flatten();
    let others = counts.filter(|c| c["cause"] != "reflex" && c["cause"] != "start");
    others.filter_map(|c| c["count"].as_u64()).sum()
}

/// How late the latest beat of any real-time thread was.
fn latest(status: &Value) -> Span {
    let layers = status["layers"].as_array().into_iter().flatten();
    let late = layers.filter_map(|l| l["latency_us"]["max"].as_f64());
    Span((late.fold(0.0, f64::max) * 1e3) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn status(count: u64, late_us: f64) -> Value {
        json!({
            "halt": {"counts": [{"cause": "reflex", "count": 9}, {"cause": "stale command", "count": count}]},
            "layers": [{"latency_us": {"max": late_us}}],
        })
    }

    #[test]
    fn an_unexpected_halt_breaks_unless_the_host_was_late() {
        let mut outcome = Outcome::default();
        outcome.expect_no_halt(&status(1, 0.0), &status(1, 0.0));
        assert!(outcome.broken.is_empty());
        outcome.expect_no_halt(&status(1, 0.0), &status(3, 20_000.0));
        assert_eq!((outcome.host_halts, outcome.broken.len()), (2, 0));
        outcome.expect_no_halt(&status(1, 0.0), &status(2, 100.0));
        assert_eq!(outcome.broken.len(), 1);
    }

    #[test]
    fn a_missed_halt_a_late_one_and_a_contact_break() {
        let broken = |halted: Option<u64>, late: u64| {
            let mut outcome = Outcome {
                injections: 1,
                ..Outcome::default()
            };
            outcome.halted(halted.map(Span::millis), Span::millis(60), Span::millis(late));
            outcome.judge(Expected::Halt);
            outcome.broken
        };
        assert!(broken(None, 0)[0].starts_with("MISSED"));
        assert_eq!(broken(Some(61), 0).len(), 1);
        assert_eq!(broken(Some(61), 2).len(), 0);
        let mut hit = Outcome {
            contacts: 1,
            allocations: 1,
            ..Outcome::default()
        };
        hit.judge(Expected::GoesOn);
        assert_eq!(hit.broken.len(), 2);
    }

    #[test]
    fn a_fault_that_nobody_looked_at_breaks() {
        let mut outcome = Outcome {
            injections: 2,
            ..Outcome::default()
        };
        outcome.halted(Some(Span::millis(1)), Span::millis(60), Span::ZERO);
        outcome.judge(Expected::Halt);
        assert_eq!(outcome.not_as_specified(), 1);
    }
}
