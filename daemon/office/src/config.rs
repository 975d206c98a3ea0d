//! What an office is made from: the seed, who is in it, how well the robot senses.
//!
//! Plain data. Nothing here moves and nothing here draws a random number.

use crate::Layout;
use crate::camera::CameraModel;
use crate::sonar::SonarModel;
use serde::Serialize;

/// Radius of the robot's round base, m. Allen was about 0.4 m across.
pub const ROBOT_RADIUS_M: f64 = 0.20;
/// Radius of a standing person seen from above, m: a shoulder breadth of 0.44 m.
pub const PERSON_RADIUS_M: f64 = 0.22;
/// Most robots that one office holds.
pub const ROBOTS_MAX: usize = 4;
/// Most people, attackers and placed ones together, that one office holds: a bound for the buffers.
pub const PEOPLE_MAX: usize = 64;

/// Everything that decides how an office will run; equal configurations run equally, to the bit.
#[derive(Clone, Debug)]
pub struct Config {
    /// Seed of every random draw in the office.
    pub seed: u64,
    /// People who walk about on business of their own.
    pub people: u32,
    /// People who walk straight at the robot, stand in its way, leave, and come back.
    pub attackers: u32,
    /// People who put themselves where the robot has a wall behind it, and stay.
    pub cornerers: u32,
    /// People who stand about in groups of three and talk.
    pub talkers: u32,
    /// Doors and chairs.
    pub fittings: FittingsModel,
    /// The robot's ring of sonars.
    pub sonar: SonarModel,
    /// The robot's range camera.
    pub camera: CameraModel,
    /// The robot's wheel odometry and compass.
    pub odometry: OdometryModel,
    /// The robot's base.
    pub base: BaseModel,
    /// Walls, furniture, way points.
    pub layout: Layout,
    /// Where the robot starts: x m, y m, heading rad (counter-clockwise from the x axis).
    /// `None` takes the layout's own start.
    pub start: Option<(f64, f64, f64)>,
    /// Where further robots start, at most [`ROBOTS_MAX`] in all.
    pub others: Vec<(f64, f64, f64)>,
}

impl Default for Config {
    /// The standard office: six people at work, two who pester the robot, noisy sensors.
    fn default() -> Self {
        Config {
            seed: 1,
            people: 6,
            attackers: 2,
            cornerers: 0,
            talkers: 0,
            fittings: FittingsModel::default(),
            sonar: SonarModel::default(),
            camera: CameraModel::default(),
            odometry: OdometryModel::default(),
            base: BaseModel::default(),
            layout: Layout::office(),
            start: None,
            others: Vec::new(),
        }
    }
}

/// How often people change the office. All figures are our choice; nought means never.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittingsModel {
    /// Mean time that a door stands open, s.
    pub door_open_s: f64,
    /// Mean time that a door stays closed if nobody comes, s.
    pub door_closed_s: f64,
    /// Mean time between two moves of one chair, s.
    pub chair_s: f64,
}

impl Default for FittingsModel {
    fn default() -> Self {
        FittingsModel {
            door_open_s: 300.0,
            door_closed_s: 40.0,
            chair_s: 240.0,
        }
    }
}

/// How the dead-reckoned pose strays from the true one. All figures are our choice, of the size
/// usual for an uncalibrated differential drive with a compass on an office floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryModel {
    /// Error of the wheels' size, as a fraction: one sigma, drawn once for each run.
    pub scale_sigma: f64,
    /// Slip: one sigma of the position error along and across the path, m for each square root of
    /// a metre travelled.
    pub slip_m: f64,
    /// Compass error: one sigma, rad. The error wanders with the time constant below and never
    /// grows beyond this size.
    pub compass_sigma_rad: f64,
    /// Time constant with which the compass error wanders, s.
    pub compass_tau_s: f64,
}

impl Default for OdometryModel {
    fn default() -> Self {
        OdometryModel {
            scale_sigma: 0.01,
            slip_m: 0.01,
            compass_sigma_rad: 0.02,
            compass_tau_s: 20.0,
        }
    }
}

impl OdometryModel {
    /// Odometry that is never wrong as long as no wheel is forced to slip.
    pub fn perfect() -> Self {
        OdometryModel {
            scale_sigma: 0.0,
            slip_m: 0.0,
            compass_sigma_rad: 0.0,
            compass_tau_s: 20.0,
        }
    }
}

/// Limits of the robot's differential-drive base: a slow indoor machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseModel {
    /// Highest speed forward or back, m/s.
    pub speed_max_m_s: f64,
    /// Highest turning speed, rad/s.
    pub turn_max_rad_s: f64,
    /// Greatest acceleration away from standstill, m/s².
    pub acceleration_m_s2: f64,
    /// Greatest braking, m/s².
    pub braking_m_s2: f64,
    /// Greatest change of the turning speed, rad/s².
    pub turn_acceleration_rad_s2: f64,
}

impl Default for BaseModel {
    fn default() -> Self {
        BaseModel {
            speed_max_m_s: 0.3,
            turn_max_rad_s: 1.5,
            acceleration_m_s2: 0.5,
            braking_m_s2: 1.0,
            turn_acceleration_rad_s2: 4.0,
        }
    }
}

/// What the base is told to do. Values outside the base's limits are cut to them; a value that is
/// not a number counts as zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Speed forward, m/s; negative drives back.
    pub forward: f64,
    /// Turning speed, rad/s, counter-clockwise positive.
    pub turn: f64,
}

/// A place and a direction in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Pose {
    /// m, to the east of the layout's south-west corner.
    pub x: f64,
    /// m, to the north of the layout's south-west corner.
    pub y: f64,
    /// rad in (-π, π], counter-clockwise from the x axis.
    pub heading: f64,
}
