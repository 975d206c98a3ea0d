//! The battery: how long the robot runs, and where it charges.
//!
//! Must never know a layer: it says what is left on a wire, and that is all.

use ipc::clock::Time;

/// A battery, and the place where it charges.
#[derive(Clone, Copy, Debug)]
pub struct Battery {
    /// Share of the charge that is left.
    pub left: f64,
    /// Times that it ran out.
    pub flat: u64,
    /// Times that charging began.
    pub charges: u64,
    pub(super) hours: f64,
    home: (f64, f64),
    charging: bool,
    last: Option<Time>,
    pub(super) told: Option<Time>,
}

/// As near to where it started the robot charges, m.
const DOCK_M: f64 = 0.8;
/// So much faster than it empties the battery charges.
const CHARGING: f64 = 10.0;
/// Below this share charging is worth counting.
const CHARGE_BELOW: f64 = 0.6;

impl Battery {
    pub(super) fn new(hours: f64, home: (f64, f64)) -> Battery {
        Battery {
            left: 1.0,
            flat: 0,
            charges: 0,
            hours,
            home,
            charging: false,
            last: None,
            told: None,
        }
    }

    /// Lets time pass up to `now` with the robot at `at`; says whether it has any charge.
    pub(super) fn pass(&mut self, now: Time, at: (f64, f64)) -> bool {
        let gone = self
            .last
            .replace(now)
            .map_or(0.0, |last| now.since(last).seconds());
        if self.hours <= 0.0 {
            return true;
        }
        let docked = (at.0 - self.home.0).hypot(at.1 - self.home.1) < DOCK_M;
        if docked && !self.charging && self.left < CHARGE_BELOW {
            self.charges += 1;
            self.charging = true;
        }
        self.charging &= docked;
        let share = gone / (self.hours * 3600.0);
        let had = self.left > 0.0;
        self.left += if docked { share * CHARGING } else { -share };
        self.left = self.left.clamp(0.0, 1.0);
        self.flat += u64::from(had && self.left == 0.0);
        self.left > 0.0
    }
}
