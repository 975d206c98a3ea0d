//! The rover: what Allen's body is in every simulated world, a round robot with a ring of twelve sonars.
//!
//! ```text
//!  in:  ping (fires the ring), turn rad/s, forward m/s      out: sonar m, compass rad, odometry
//! ```
//! Must never know which world it stands in: wiring files for levels 0 and 1 run in all of them as they are.

use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Payload, Pose, SONARS};
use ipc::wiring::{Declaration, Port};

use super::{BodyKind, Build, WorldEnd};

/// The input that fires the ring.
pub(super) const PING: usize = 0;
/// The input that turns it.
pub(super) const TURN: usize = 1;
/// The input that drives it.
pub(super) const FORWARD: usize = 2;

/// The output of the ring.
pub(super) const SONAR: usize = 0;
/// The output of the compass.
pub(super) const COMPASS: usize = 1;
/// The output of the wheels' counters.
pub(super) const ODOMETRY: usize = 2;

/// The input ports.
pub(super) const COMMANDS: &[Port] = &[
    Port::new("ping", Kind::Pulse, "fires the ring of sonars"),
    Port::new("turn", Kind::Number, "turning rate")
        .unit("rad/s")
        .between(-10.0, 10.0),
    Port::new("forward", Kind::Number, "forward speed")
        .unit("m/s")
        .between(-2.0, 2.0),
];

/// The output ports; a world may have more after them.
pub(super) const SENSES: &[Port] = &[
    Port::new("sonar", Kind::Map, "what the ring heard, straight ahead first")
        .unit("m")
        .between(0.0, 100.0),
    Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    Port::new("odometry", Kind::Pose, "where the wheels think they are"),
];

/// The kind of body that stands in the world that `build` builds.
pub(super) const fn kind(declaration: &'static Declaration, build: Build) -> BodyKind {
    BodyKind {
        declaration,
        motion: &[TURN, FORWARD],
        forward: Some(FORWARD),
        stale: Span::millis(200),
        build,
    }
}

/// Says what the ring heard, m.
pub(super) fn tell_sonar(link: &mut WorldEnd, now: Time, ranges: [f64; SONARS]) {
    link.tell(SONAR, now, &Map { ranges }.pack());
}

/// Says which way it faces and where it thinks it is.
pub(super) fn tell_pose(link: &mut WorldEnd, now: Time, believed: Pose) {
    link.tell(COMPASS, now, &believed.heading.pack());
    link.tell(ODOMETRY, now, &believed.pack());
}

/// Longest step of the physics.
const STEP_MAX: Span = Span::millis(20);
/// Longest gap that is made up for; after a longer one the world goes on from where it was.
const GAP_MAX: Span = Span::secs(1);

/// How far a simulated world has come.
#[derive(Debug, Default)]
pub(super) struct Progress(Option<Time>);

impl Progress {
    /// The steps in which the world comes to `now`, in s; none if it is there already.
    pub(super) fn steps_to(&mut self, now: Time) -> impl Iterator<Item = f64> + use<> {
        let last = self.0.map_or(now, |last| last.min(now));
        self.0 = self.0.max(Some(now));
        let mut left = now.since(last).0.min(GAP_MAX.0);
        std::iter::from_fn(move || {
            let step = Span(left.min(STEP_MAX.0));
            left -= step.0;
            (step > Span::ZERO).then(|| step.seconds())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_moment_is_lived_once_and_a_long_gap_is_cut() {
        let mut progress = Progress::default();
        let mut lived = |ms: u64| progress.steps_to(Time(ms * 1_000_000)).collect::<Vec<f64>>();
        assert_eq!(lived(500), [0.0; 0], "the first look is the beginning");
        assert_eq!(lived(545), [0.02, 0.02, 0.005]);
        assert_eq!(lived(545), [0.0; 0], "a second robot at the same moment");
        assert_eq!(lived(520), [0.0; 0], "a moment that is over");
        assert_eq!(lived(550), [0.005]);
        assert_eq!(lived(60_000).len(), 50, "one second of a minute");
        assert_eq!(lived(60_020), [0.02]);
    }
}
