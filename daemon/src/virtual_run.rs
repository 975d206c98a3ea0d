//! A run on the virtual clock: the same layers, wiring and body, stepped in one thread as fast as it goes.
//!
//! Must never depend on the order of things that happen at one moment: every layer due looks at its registers
//! before any of them writes, and those of a higher level write first, so that an inhibitor's message
//! of this very moment counts.
//!
//! ```text
//!   t ─► gather and step every layer due ─► motor unit gathers ─► commit, highest level first
//!     ─► motor unit acts ─► world ticks ─► next t
//! ```

use ipc::clock::{Span, Time};

use crate::executor::deadline::Verdict;
use crate::machine::{Machine, Station};

/// A creature on the virtual clock.
pub struct VirtualRun {
    /// The machine being stepped.
    pub machine: Machine,
    now: Time,
    due: Vec<Time>,
    body_due: Time,
}

/// The moment at which virtual time begins: not zero, so that nothing is mistaken for never.
pub const BEGIN: Time = Time(1_000_000_000);

impl VirtualRun {
    /// A run that is about to begin.
    pub fn new(machine: Machine) -> VirtualRun {
        let due = machine.stations.iter().map(|s| BEGIN + s.spec.phase).collect();
        VirtualRun {
            machine,
            now: BEGIN,
            due,
            body_due: BEGIN,
        }
    }

    /// The virtual time, since [`BEGIN`].
    pub fn elapsed(&self) -> Span {
        self.now.since(BEGIN)
    }

    /// Lets `span` pass.
    pub fn advance(&mut self, span: Span) {
        let end = self.now + span;
        while let Some(t) = self.next().filter(|t| *t < end) {
            self.now = t;
            self.beat(t);
        }
        self.now = end;
    }

    fn next(&self) -> Option<Time> {
        let layers = self.due.iter().copied();
        let body = self.machine.body.is_some().then_some(self.body_due);
        layers.chain(body).min()
    }

    /// Everything that is due at `t`.
    fn beat(&mut self, t: Time) {
        let Machine {
            stations,
            hands,
            body,
            ..
        } = &mut self.machine;
        for (station, due) in stations.iter_mut().zip(&self.due) {
            if *due == t {
                station.running.step(t);
            }
        }
        let mut body_due = body.as_mut().filter(|_| self.body_due == t);
        // The motor unit looks before anything of this moment is written.
        if let Some(body) = &mut body_due {
            body.motor.gather(t);
        }
        // Stations stand in order of level; the highest writes first.
        for (station, due) in stations.iter_mut().zip(&mut self.due).rev() {
            if *due == t {
                commit(station, t);
                *due = *due + station.spec.period;
            }
        }
        if let Some(body) = body_due {
            body.motor.act(t);
            body.gauge.beat(t, Verdict::default(), true);
            body.world.tick(t, &mut body.link);
            self.body_due = t + body.motor.period();
        }
        for hand in hands {
            while hand.returned.pop().is_ok() {}
        }
    }
}

fn commit(station: &mut Station, t: Time) {
    station.running.commit(t);
    station.gauge.beat(t, Verdict::default(), true);
}
