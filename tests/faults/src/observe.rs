//! The observer: a real-time thread that looks at a body's pulse twice a millisecond, and at how late it is itself.
//!
//! ```text
//!   body process ──► cell of its page: stamp of the turn, causes of its own gate ──► changes, kept with the stamp
//! ```
//! Must never judge by its own clock when the gate closed: the stamp of the body's turn says so.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use daemon::executor::host;
use ipc::body::{PULSE_KIND, Pulse, owner_of};
use ipc::clock::{self, Span, Time};
use ipc::wire::Reader;
use ipc::wire::iceoryx::Domain;

use crate::trial::BODY;

/// Time between two looks.
const LOOK: Span = Span::micros(500);

/// Priority: above the layers, below motor unit and watchdog.
const PRIORITY: u8 = 60;

#[derive(Debug, Default)]
struct Seen {
    /// When the body's gate closed or opened, and its causes from then on.
    changes: Mutex<Vec<(Time, u32)>>,
    /// Its longest lateness, in nanoseconds.
    late: AtomicU64,
    stop: AtomicBool,
}

/// The observer.
#[derive(Debug)]
pub(crate) struct Observer {
    seen: Arc<Seen>,
    thread: Option<JoinHandle<()>>,
    domain: Option<Domain>,
}

impl Observer {
    /// Looks at nothing but its own lateness.
    ///
    /// # Errors
    /// When the host refuses a thread.
    pub(crate) fn of_the_host() -> Result<Observer, String> {
        Observer::start(None, None, Span::ZERO)
    }

    /// Looks at the pulse of the stage's body process as well, which turns once a `period`, and at how late its turns
    /// are: the host may hold up the one and not the other. Zero for a body that is frozen on purpose.
    ///
    /// # Errors
    /// When its page cannot be mapped.
    pub(crate) fn of_the_body(period: Span) -> Result<Observer, String> {
        let domain = Domain::join("observer").map_err(|e| e.to_string())?;
        let page = domain.map(&owner_of(BODY)).map_err(|e| e.to_string())?;
        let pulse = page
            .len()
            .checked_sub(1)
            .and_then(|last| page.reader(last, PULSE_KIND));
        let pulse = pulse.ok_or("the page of the body is empty")?;
        Observer::start(Some(pulse), Some(domain), period)
    }

    fn start(pulse: Option<Reader>, domain: Option<Domain>, period: Span) -> Result<Observer, String> {
        let seen = Arc::new(Seen::default());
        let shown = seen.clone();
        host::limit_runaway();
        let thread = std::thread::Builder::new()
            .name("observer".into())
            .spawn(move || {
                // Refused: then its own lateness is an ordinary thread's, which excuses more.
                let _ = host::schedule_fifo(PRIORITY);
                look_on(&shown, pulse.as_ref(), &mut Turns::of(period));
            });
        let thread = thread.map_err(|e| format!("a thread: {e}"))?;
        Ok(Observer {
            seen,
            thread: Some(thread),
            domain,
        })
    }

    /// Forgets how late it was so far.
    pub(crate) fn begin(&self) {
        self.seen.late.store(0, Ordering::Relaxed);
    }

    /// Breaks something, not before `fault`. The host may hold up who does: when the fault came is known to within that.
    pub(crate) fn while_breaking<T>(&self, fault: Time, act: impl FnOnce() -> T) -> T {
        let done = act();
        self.held_up(clock::monotonic().since(fault));
        done
    }

    /// Takes in what else the host was seen to hold up.
    pub(crate) fn held_up(&self, by: Span) {
        self.seen.late.fetch_max(by.0, Ordering::Relaxed);
    }

    /// Its longest lateness since [`begin`](Observer::begin).
    pub(crate) fn late(&self) -> Span {
        Span(self.seen.late.load(Ordering::Relaxed))
    }

    /// Whether the body's gate is open now.
    pub(crate) fn is_open(&self) -> bool {
        let changes = self.seen.changes.lock().expect("nobody panics holding it");
        changes.last().is_some_and(|(_, causes)| *causes == 0)
    }

    /// When the body's gate first closed after `moment`.
    pub(crate) fn closed_after(&self, moment: Time) -> Option<Time> {
        let changes = self.seen.changes.lock().expect("nobody panics holding it");
        let closed = changes.iter().find(|(at, causes)| *at >= moment && *causes != 0);
        closed.map(|(at, _)| *at)
    }
}

impl Drop for Observer {
    fn drop(&mut self) {
        self.seen.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        if let Some(domain) = self.domain.take() {
            domain.leave();
        }
    }
}

/// The turns of a body, which are due on a grid.
#[derive(Debug)]
struct Turns {
    period: i64,
    last: Option<Time>,
    /// How far from the first turn's grid the earliest turn was: the grid itself, as near as it was seen.
    earliest: i64,
    first: Time,
}

impl Turns {
    fn of(period: Span) -> Turns {
        Turns {
            period: period.0 as i64,
            last: None,
            earliest: 0,
            first: Time::ZERO,
        }
    }

    /// How late the turn at `stamp` was, as far as the turns before it tell.
    fn late(&mut self, stamp: Time) -> Span {
        let Some(last) = self.last.replace(stamp) else {
            self.first = stamp;
            return Span::ZERO;
        };
        if stamp == last || self.period == 0 {
            return Span::ZERO;
        }
        let passed = stamp.0 as i64 - self.first.0 as i64;
        let off = (passed + self.period / 2).rem_euclid(self.period) - self.period / 2;
        self.earliest = self.earliest.min(off);
        let left_out = stamp.since(last).0 as i64 - self.period;
        Span(left_out.max(off - self.earliest).max(0) as u64)
    }
}

fn look_on(seen: &Seen, pulse: Option<&Reader>, turns: &mut Turns) {
    let mut before = None;
    let mut due = clock::monotonic();
    while !seen.stop.load(Ordering::Relaxed) {
        let now = clock::monotonic();
        seen.late.fetch_max(now.since(due).0, Ordering::Relaxed);
        if let Some(reading) = pulse.and_then(Reader::read) {
            let causes = Pulse::unpack(&reading.words).causes;
            seen.late
                .fetch_max(turns.late(reading.stamp).0, Ordering::Relaxed);
            if before != Some(causes) {
                let mut changes = seen.changes.lock().expect("nobody panics holding it");
                changes.push((reading.stamp, causes));
                before = Some(causes);
            }
        }
        due = due.max(now - LOOK) + LOOK;
        clock::sleep_until(due);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_turn_is_told_from_a_grid_that_was_first_met_late() {
        let mut turns = Turns::of(Span::millis(20));
        let late = |ms| turns.late(Time(Span::millis(ms).0)).as_millis_f64();
        // Due at 100, 120, … of which the first was 3 ms late.
        assert_eq!([103, 103, 120, 141, 160].map(late), [0.0, 0.0, 0.0, 1.0, 0.0]);
        let mut turns = Turns::of(Span::millis(20));
        let late = |ms| turns.late(Time(Span::millis(ms).0)).as_millis_f64();
        // One that was left out, and one that came with the next.
        assert_eq!([100, 140, 160, 175].map(late), [0.0, 20.0, 0.0, 0.0]);
    }
}
