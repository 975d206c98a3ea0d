//! The robot's base: wheels with limits, and the odometry that believes them.
//!
//! The base never decides anything. A command is followed as fast as the limits allow; where the
//! disc then ends is `discs.rs`'s business. When something holds the base, the wheels slip: the
//! odometry counts what they turned, the floor does not.

use crate::config::{BaseModel, Drive, OdometryModel, Pose, ROBOT_RADIUS_M};
use crate::discs::Disc;
use crate::noise::Noise;
use crate::plane::{Vec2, vec2, wrapped};

pub(crate) struct Robot {
    base: BaseModel,
    model: OdometryModel,
    noise: Noise,
    pub(crate) at: Vec2,
    pub(crate) heading: f64,
    /// What the wheels do now: m/s forward.
    forward: f64,
    /// What the wheels do now: rad/s.
    turn: f64,
    /// How the base really moved in this step and in the one before, m/s.
    moved: [Vec2; 2],
    /// m along the true path.
    pub(crate) travelled: f64,
    believed: Vec2,
    /// The wheels' true size as a fraction of what the odometry takes it for.
    scale: f64,
    compass_error: f64,
}

/// Cuts a command to ±`limit`; what is not a number is zero.
fn limited(value: f64, limit: f64) -> f64 {
    if value.is_nan() {
        0.0
    } else {
        value.clamp(-limit, limit)
    }
}

/// `now` moved toward `target` by at most `step`.
fn toward(now: f64, target: f64, step: f64) -> f64 {
    now + (target - now).clamp(-step, step)
}

impl Robot {
    pub(crate) fn new(
        base: BaseModel,
        model: OdometryModel,
        start: (f64, f64, f64),
        mut noise: Noise,
    ) -> Robot {
        let at = vec2(start.0, start.1);
        let scale = 1.0 + model.scale_sigma * noise.gauss();
        let compass_error = model.compass_sigma_rad * noise.gauss();
        Robot {
            base,
            model,
            noise,
            at,
            heading: wrapped(start.2),
            forward: 0.0,
            turn: 0.0,
            moved: [Vec2::default(); 2],
            travelled: 0.0,
            believed: at,
            scale,
            compass_error,
        }
    }

    pub(crate) fn disc(&self) -> Disc {
        Disc {
            at: self.at,
            radius: ROBOT_RADIUS_M,
        }
    }

    pub(crate) fn pose(&self) -> Pose {
        Pose {
            x: self.at.x,
            y: self.at.y,
            heading: self.heading,
        }
    }

    /// What odometry and compass say.
    pub(crate) fn believed_pose(&self) -> Pose {
        let heading = wrapped(self.heading + self.compass_error);
        Pose {
            x: self.believed.x,
            y: self.believed.y,
            heading,
        }
    }

    /// The base's own speed in `direction`, m/s, at the moment of a contact in this step. What it
    /// touched has already cut this step's move short, so the step before counts too; wheels that
    /// slip under a base held fast do not count.
    pub(crate) fn approach(&self, direction: Vec2) -> f64 {
        self.moved[0].dot(direction).max(self.moved[1].dot(direction))
    }

    /// Brings the wheels nearer to the command, turns, and says where the base would like to be.
    pub(crate) fn drive(&mut self, dt_s: f64, command: Drive) -> Vec2 {
        let target = limited(command.forward, self.base.speed_max_m_s);
        let braking = self.forward != 0.0
            && (target * self.forward < 0.0 || libm::fabs(target) < libm::fabs(self.forward));
        if braking {
            // Braking ends at standstill; the other way is taken up with the acceleration.
            let stop = if target * self.forward < 0.0 { 0.0 } else { target };
            self.forward = toward(self.forward, stop, self.base.braking_m_s2 * dt_s);
        } else {
            self.forward = toward(self.forward, target, self.base.acceleration_m_s2 * dt_s);
        }
        let turn = limited(command.turn, self.base.turn_max_rad_s);
        self.turn = toward(self.turn, turn, self.base.turn_acceleration_rad_s2 * dt_s);
        let half = self.turn * dt_s / 2.0;
        let wanted = self.at + Vec2::at_angle(self.heading + half) * (self.forward * dt_s);
        self.heading = wrapped(self.heading + self.turn * dt_s);
        wanted
    }

    /// Takes the place where the base came to rest this step, and lets the odometry count.
    pub(crate) fn settle(&mut self, dt_s: f64, now: Vec2) {
        self.travelled += (now - self.at).length();
        self.moved = [(now - self.at) * (1.0 / dt_s), self.moved[0]];
        self.at = now;
        let model = &self.model;
        let (along, across, wander) = (self.noise.gauss(), self.noise.gauss(), self.noise.gauss());
        // An Ornstein-Uhlenbeck process, which keeps the error's sigma constant.
        let keep = libm::exp(-dt_s / model.compass_tau_s);
        let fresh = model.compass_sigma_rad * libm::sqrt(1.0 - keep * keep);
        self.compass_error = self.compass_error * keep + fresh * wander;
        let rolled = self.forward * dt_s;
        let slip = model.slip_m * libm::sqrt(libm::fabs(rolled));
        let ahead = Vec2::at_angle(self.heading + self.compass_error);
        self.believed =
            self.believed + ahead * (rolled * self.scale + slip * along) + ahead.left() * (slip * across);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Use;

    fn robot() -> Robot {
        let noise = Noise::new(1, Use::Odometry);
        Robot::new(
            BaseModel::default(),
            OdometryModel::perfect(),
            (0.0, 0.0, 0.0),
            noise,
        )
    }

    fn drive(robot: &mut Robot, seconds: f64, forward: f64, turn: f64) {
        for _ in 0..(seconds * 50.0).round() as u32 {
            let wanted = robot.drive(0.02, Drive { forward, turn });
            robot.settle(0.02, wanted);
        }
    }

    #[test]
    fn the_wheels_keep_their_limits() {
        let mut robot = robot();
        drive(&mut robot, 0.2, 9.0, 9.0);
        assert!(
            (robot.forward - 0.1).abs() < 1e-9,
            "0.5 m/s² for 0.2 s gives {}",
            robot.forward
        );
        assert!(
            (robot.turn - 0.8).abs() < 1e-9,
            "4 rad/s² for 0.2 s gives {}",
            robot.turn
        );
        drive(&mut robot, 2.0, 9.0, f64::NAN);
        assert_eq!((robot.forward, robot.turn), (0.3, 0.0));
        drive(&mut robot, 0.1, -9.0, 0.0);
        assert!(
            (robot.forward - 0.2).abs() < 1e-9,
            "1 m/s² of braking for 0.1 s gives {}",
            robot.forward
        );
    }

    #[test]
    fn perfect_odometry_agrees_with_the_truth() {
        let mut robot = robot();
        drive(&mut robot, 10.0, 0.3, 0.3);
        let (truth, belief) = (robot.pose(), robot.believed_pose());
        let off = (vec2(truth.x, truth.y) - vec2(belief.x, belief.y)).length();
        assert!(off < 0.02 && truth.heading == belief.heading, "off by {off} m");
    }
}
