//! How people are: paces, patience, distances.
//!
//! Must never hold more than numbers.

/// Slowest and fastest pace of a walker, m/s: people indoors with a coffee in hand.
pub(super) const PACE_M_S: (f64, f64) = (0.4, 0.7);
/// Pace of an attacker, m/s: faster than the robot can flee.
pub(super) const ATTACK_PACE_M_S: f64 = 0.5;
/// How fast people change their velocity, m/s².
pub(super) const ACCELERATION_M_S2: f64 = 2.0;
/// A way point counts as reached within this distance, m.
pub(super) const REACHED_M: f64 = 0.22;
/// How long a walker stands at a goal, s.
pub(super) const STAND_S: (f64, f64) = (2.0, 20.0);
/// How long one stands who made no headway, before trying another goal, s.
pub(super) const BALKED_S: (f64, f64) = (0.5, 3.0);
/// How long an attacker stands in front of the robot, s.
pub(super) const PESTER_S: (f64, f64) = (2.0, 6.0);
/// How long a cornerer stands before a robot in a corner, s.
pub(super) const CORNER_S: (f64, f64) = (6.0, 20.0);
/// Gap at which a cornerer stops, m.
pub(super) const CORNER_OFF_M: (f64, f64) = (0.1, 0.4);
/// From this distance on a cornerer makes for the open side of the robot, m from middle to middle.
pub(super) const CORNER_M: f64 = 0.9;
/// A wall farther than this from the robot's middle is no corner yet, m.
pub(super) const CORNERED_M: f64 = 2.5;
/// How many stand together and talk.
pub(crate) const GROUP: usize = 3;
/// How far from the middle of the group each stands, m.
pub(super) const GROUP_RADIUS_M: f64 = 0.5;
/// How long a group talks in one place, ways there included, s.
pub(super) const GROUP_S: f64 = 75.0;
/// How long an attacker stays away, s.
pub(super) const AWAY_S: (f64, f64) = (15.0, 60.0);
/// Gap to the robot at which an attacker stops, m; below zero means walking up until they touch.
pub(super) const STAND_OFF_M: (f64, f64) = (-0.1, 0.3);
/// An attacker lets the robot get this much farther than the stand-off before following, m.
pub(super) const FOLLOW_M: f64 = 0.4;
/// People begin to go round somebody at this gap, m.
pub(super) const ASIDE_M: f64 = 0.6;
/// Headway is looked at this often, s, and should be at least so many m.
pub(super) const HEADWAY: (f64, f64) = (3.0, 0.25);
/// How often an attacker looks where the robot is, s.
pub(super) const LOOK_S: f64 = 0.5;
/// Radius that must be free for an attacker to walk straight at the robot, m: a little less than the
/// robot's, or a robot against a wall could hide there.
pub(super) const APPROACH_RADIUS_M: f64 = 0.18;
/// Probability that a walker on the way to a goal does not notice the robot: reading on the move.
pub(super) const CARELESS: f64 = 0.15;
