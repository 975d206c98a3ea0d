//! What passes between the robot's body and its hierarchy when wires lie between them.
//!
//! ```text
//!   world ── Sensed: proprioception, cues, what the eyes see ──► belief ──► hierarchy
//!     ▲                                                                         │
//!     └── Setpoints: wheel, steering, arm, hand ◄── motor control units ◄───────┘
//! ```
//! A setpoint says how things shall be, not what shall be done once: saying it again changes nothing, and one that
//! is lost is made good by the next.
//!
//! Must never: hold anything without a bound, for all of it goes into messages of fixed length.

use super::geometry::Point;
use super::motor::{ARM_M_S, ARM_RAD_S, STEERING_RAD_S};
use super::motor::{HAND_M, HAND_S, ON_THE_SPOT_STEERING_RAD, approach};
use super::robot::{ARM_M, METRES_ON_A_TANK, SPEED_M_S, STOWED_M, WHEELBASE_M};
use super::world::{BEAT_S, World};

/// Objects, stations, sites and persons told at once, the nearest of each: three numbers each in one message of
/// twelve.
pub const TOLD_MAX: usize = 4;
/// Obstacles told at once: three messages of the same make.
pub const OBSTACLES_TOLD_MAX: usize = 12;

/// Something that the eyes see.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Told {
    /// Its number; zero is nothing. Of an obstacle its radius, in millimetres.
    pub number: u32,
    /// Where it is, metres.
    pub place: Point,
}

/// What the sensors say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// Time since the start, seconds.
    pub now_s: f64,
    /// Middle of the body, metres.
    pub place: Point,
    /// Where it looks, radians from east.
    pub heading_rad: f64,
    /// Steering wheel against straight ahead, radians.
    pub steering_rad: f64,
    /// Way of the driven wheel since the start, metres; backwards counts as well.
    pub rolled_m: f64,
    /// Direction of the arm against the heading, radians.
    pub arm_rad: f64,
    /// Length of the arm, metres.
    pub arm_m: f64,
    /// The object in the hand; zero is none.
    pub held: u32,
    /// Fuel, from 0 to 1.
    pub fuel: f64,
    /// Fuel flows.
    pub filling: bool,
    /// The body is against something.
    pub bumped: bool,
    /// Temperature is below the threshold.
    pub cold: bool,
    /// An order is heard.
    pub ordered: bool,
    /// Someone whistles.
    pub whistle: bool,
    /// A red light is on.
    pub red_light: bool,
    /// Objects in view that lie at no site in use.
    pub objects: [Told; TOLD_MAX],
    /// Stations in view.
    pub stations: [Told; TOLD_MAX],
    /// Persons in view.
    pub persons: [Told; TOLD_MAX],
    /// A place in view that meets the criteria of a nest site.
    pub site: Told,
    /// How many objects lie there.
    pub lying: u32,
    /// Obstacles in view, their radius for a number.
    pub obstacles: [Told; OBSTACLES_TOLD_MAX],
}

/// How the actuators shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoints {
    /// Speed of the driven wheel, metres a second.
    pub wheel_m_s: f64,
    /// Steering wheel against straight ahead, radians.
    pub steering_rad: f64,
    /// Direction of the arm against the heading, radians.
    pub arm_rad: f64,
    /// Length of the arm, metres.
    pub arm_m: f64,
    /// What the hand shall hold; zero is nothing.
    pub hold: u32,
}

impl Setpoints {
    /// Standing still, the arm stowed, the hand open.
    pub const STILL: Self = Self {
        wheel_m_s: 0.0,
        steering_rad: 0.0,
        arm_rad: 0.0,
        arm_m: STOWED_M,
        hold: 0,
    };
}

impl World {
    /// One beat with the actuators as they shall be; without setpoints nothing of the robot moves.
    pub fn live(&mut self, setpoints: Option<&Setpoints>) {
        self.begin_beat();
        self.robot.bumped = false;
        if let Some(setpoints) = setpoints {
            self.roll(setpoints.wheel_m_s, setpoints.steering_rad);
            let robot = &mut self.robot;
            robot.arm_rad = approach(robot.arm_rad, setpoints.arm_rad, ARM_RAD_S * BEAT_S);
            let wanted_m = setpoints.arm_m.clamp(STOWED_M / 2.0, ARM_M);
            robot.arm_m = approach(robot.arm_m, wanted_m, ARM_M_S * BEAT_S);
            self.move_hand(setpoints.hold);
        }
        self.end_beat();
    }

    fn roll(&mut self, speed_m_s: f64, steering_rad: f64) {
        let quarter = core::f64::consts::FRAC_PI_2;
        let wanted_rad = steering_rad.clamp(-quarter, quarter);
        self.robot.steering_rad = approach(self.robot.steering_rad, wanted_rad, STEERING_RAD_S * BEAT_S);
        let wheel_m = speed_m_s.clamp(-SPEED_M_S, SPEED_M_S) * BEAT_S;
        if wheel_m == 0.0 || self.robot.fuel <= 0.0 {
            return;
        }
        let (steering_rad, heading_rad) = (self.robot.steering_rad, self.robot.heading_rad);
        let on_the_spot = steering_rad.abs() > ON_THE_SPOT_STEERING_RAD;
        let turn_rad = wheel_m * libm::sin(steering_rad) / WHEELBASE_M;
        self.burn(wheel_m.abs() / METRES_ON_A_TANK);
        if !on_the_spot {
            let forward_m = wheel_m * libm::cos(steering_rad);
            let place = self.robot.place.towards(heading_rad + turn_rad / 2.0, forward_m);
            if !self.move_robot(place) {
                self.robot.bumped = true;
                self.bumps += 1;
                return;
            }
        }
        self.rolled_m += wheel_m.abs();
        self.robot.heading_rad = super::geometry::between_rad(0.0, heading_rad + turn_rad);
    }

    /// The hand needs its time to close around something at it, and to open.
    fn move_hand(&mut self, hold: u32) {
        if self.robot.held.unwrap_or(0) == hold {
            self.hand_s = 0.0;
            return;
        }
        self.hand_s += BEAT_S;
        if self.hand_s < HAND_S {
            return;
        }
        let hand = self.robot.hand();
        let near = |place: Point| place.distance_m(hand) <= HAND_M;
        self.robot.held = match hold {
            0 => None,
            _ => self
                .objects
                .iter()
                .find(|object| object.id == hold && near(object.place))
                .map(|object| object.id),
        };
        self.hand_s = 0.0;
    }

    /// What the sensors say now.
    #[must_use]
    pub fn sensed(&self) -> Sensed {
        let (robot, seen) = (&self.robot, &self.seen);
        let site = self.sites.iter().find(|site| Some(site.id) == seen.site);
        let mut obstacles = [Told::default(); OBSTACLES_TOLD_MAX];
        let standing = seen.obstacles.iter().filter(|(disc, _)| {
            let alive = self.obstacles.iter().any(|known| known.id == disc.id);
            alive && self.in_view(disc)
        });
        fill(
            &mut obstacles,
            robot.place,
            standing.map(|(disc, _)| Told {
                number: (disc.radius_m * 1e3) as u32,
                place: disc.place,
            }),
        );
        let told = |things: &[(u32, Point)]| {
            let mut list = [Told::default(); TOLD_MAX];
            let things = things.iter().map(|&(number, place)| Told { number, place });
            fill(&mut list, robot.place, things);
            list
        };
        let mut persons = [Told::default(); TOLD_MAX];
        let walking = self.persons.iter().filter(|person| self.sees(person.place, None));
        fill(
            &mut persons,
            robot.place,
            walking.map(|person| Told {
                number: person.id,
                place: person.place,
            }),
        );
        Sensed {
            now_s: self.now_s,
            place: robot.place,
            heading_rad: robot.heading_rad,
            steering_rad: robot.steering_rad,
            rolled_m: self.rolled_m,
            arm_rad: robot.arm_rad,
            arm_m: robot.arm_m,
            held: robot.held.unwrap_or(0),
            fuel: robot.fuel,
            filling: robot.filling,
            bumped: robot.bumped,
            cold: self.cold,
            ordered: self.ordered(),
            whistle: self.whistle,
            red_light: self.red_light,
            objects: told(&seen.objects),
            stations: told(&seen.stations),
            persons,
            site: site.map_or(Told::default(), |site| Told {
                number: site.id,
                place: site.place,
            }),
            lying: site.map_or(0, |site| {
                u32::try_from(self.lying_at(site.place)).unwrap_or(u32::MAX)
            }),
            obstacles,
        }
    }
}

/// Puts the things nearest to a place into a list, nearest first.
fn fill<const N: usize>(list: &mut [Told; N], from: Point, things: impl Iterator<Item = Told>) {
    let mut count = 0;
    for thing in things {
        let away_m = thing.place.distance_m(from);
        let at = list[..count]
            .iter()
            .position(|known| known.place.distance_m(from) > away_m)
            .unwrap_or(count);
        if at < N {
            count = (count + 1).min(N);
            list[at..count].rotate_right(1);
            list[at] = thing;
        }
    }
}
