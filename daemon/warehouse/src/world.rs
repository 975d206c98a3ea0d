//! The warehouse as a whole: one step moves the robot, then the people, then counts what touches.
//!
//! Must never let the robot or a person into a full cell, or into each other.

use core::f64::consts::{PI, TAU};

use rand_pcg::Pcg32;

use crate::floor::{Floor, unit};

/// Ranges in the ring.
pub const SONARS: usize = 12;
/// Radius of the robot, m.
pub const ROBOT_RADIUS_M: f64 = 0.20;
/// Radius of a person, m.
pub const PERSON_RADIUS_M: f64 = 0.20;
/// Rays in the cone of one range, and the cone's width, rad.
const CONE: (usize, f64) = (9, 0.5);
/// Nearest and farthest range, m.
const RANGE_M: (f64, f64) = (0.05, 6.0);
/// Error of a range: a share of it, and the step in which it is told, m.
const ERROR: (f64, f64) = (0.015, 0.01);
/// Share of ranges that are lost.
const LOST: f64 = 0.02;
/// How fast the wheels follow a command: time constants of speed and turn, s.
const LAG_S: (f64, f64) = (0.15, 0.08);
/// Highest speed, m/s.
const SPEED_MAX: f64 = 0.3;
/// Share by which the wheels' count is off, and the compass in rad, one uniform draw each.
const OFF: (f64, f64) = (0.02, 0.03);
/// Pace of people, m/s.
const PACE: (f64, f64) = (0.3, 0.7);
/// Gap at which two touch, and at which they have parted, m; speed from which on the robot caused it, m/s.
const TOUCH: (f64, f64, f64) = (0.002, 0.02, 0.01);

/// What an observer may know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// m, m, rad.
    pub pose: (f64, f64, f64),
    /// m.
    pub travelled_m: f64,
    /// Contacts in all.
    pub contacts: u64,
    /// Those towards which the robot itself moved at more than 1 cm/s.
    pub caused: u64,
    /// The latest of those.
    pub latest: Option<Caused>,
}

/// A contact that the robot caused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Caused {
    /// Since the beginning, s.
    pub time_s: f64,
    /// Which person, counted from 0; none for a rack, a pillar or a wall.
    pub person: Option<usize>,
    /// How fast the robot moved towards it, m/s.
    pub approach_m_s: f64,
}

#[derive(Clone, Copy, Debug)]
struct Person {
    x: f64,
    y: f64,
    heading: f64,
    pace: f64,
    /// When to choose another heading, or to go on, s.
    until: f64,
    stands: bool,
}

/// A running warehouse.
#[derive(Clone, Debug)]
pub struct Warehouse {
    floor: Floor,
    random: Pcg32,
    noise: Pcg32,
    x: f64,
    y: f64,
    heading: f64,
    speed: f64,
    turn: f64,
    moved: [(f64, f64); 2],
    counted: (f64, f64),
    scale: f64,
    compass_off: f64,
    people: Vec<Person>,
    touching: Vec<bool>,
    time_s: f64,
    report: Report,
}

impl Warehouse {
    /// The warehouse of `seed` with so many people; empty and 8 m by 6 m if `empty`.
    pub fn new(seed: u64, people: usize, empty: bool) -> Warehouse {
        let mut random = Pcg32::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15), 101);
        let floor = if empty {
            Floor::empty(8.0, 6.0)
        } else {
            Floor::draw(&mut random)
        };
        let (width, depth) = floor.size();
        let (x, y) = if empty {
            (width / 2.0, depth / 2.0)
        } else {
            (2.25, depth / 2.0)
        };
        let heading = (unit(&mut random) - 0.5) * TAU;
        let mut world = Warehouse {
            floor,
            noise: Pcg32::new(seed, 102),
            x,
            y,
            heading,
            speed: 0.0,
            turn: 0.0,
            moved: [(0.0, 0.0); 2],
            counted: (x, y),
            scale: 1.0 + OFF.0 * (2.0 * unit(&mut random) - 1.0),
            compass_off: OFF.1 * (2.0 * unit(&mut random) - 1.0),
            people: Vec::new(),
            touching: vec![false; people + 1],
            time_s: 0.0,
            report: Report::default(),
            random,
        };
        while world.people.len() < people {
            let (px, py) = (width * unit(&mut world.random), depth * unit(&mut world.random));
            let clear = world.floor.nearest(px, py, PERSON_RADIUS_M + 0.05).is_none()
                && libm::hypot(px - x, py - y) > 1.5
                && world.people.iter().all(|p| libm::hypot(px - p.x, py - p.y) > 0.5);
            if clear {
                world.people.push(Person {
                    x: px,
                    y: py,
                    heading: 0.0,
                    pace: PACE.0,
                    until: 0.0,
                    stands: true,
                });
            }
        }
        world.report.pose = (x, y, heading);
        world
    }

    /// Lets `dt` s pass with the wheels told `forward` m/s and `turn` rad/s.
    pub fn step(&mut self, dt: f64, forward: f64, turn: f64) {
        self.time_s += dt;
        let follow = |now: f64, told: f64, lag: f64| now + (told - now) * (1.0 - libm::exp(-dt / lag));
        let sound = |v: f64, most: f64| if v.is_finite() { v.clamp(-most, most) } else { 0.0 };
        self.speed = follow(self.speed, sound(forward, SPEED_MAX), LAG_S.0);
        self.turn = follow(self.turn, sound(turn, 2.0), LAG_S.1);
        self.heading = wrapped(self.heading + self.turn * dt);
        let (cos, sin) = (libm::cos(self.heading), libm::sin(self.heading));
        let way = self.speed * dt;
        let (x, y) = self.settled(None, self.x + way * cos, self.y + way * sin, ROBOT_RADIUS_M);
        let (dx, dy) = (x - self.x, y - self.y);
        self.moved = [(dx / dt, dy / dt), self.moved[0]];
        self.report.travelled_m += libm::hypot(dx, dy);
        (self.x, self.y) = (x, y);
        let believed = self.heading + self.compass_off;
        self.counted.0 += way * self.scale * libm::cos(believed);
        self.counted.1 += way * self.scale * libm::sin(believed);
        for i in 0..self.people.len() {
            self.walk(i, dt);
        }
        self.touch();
        self.report.pose = (self.x, self.y, self.heading);
    }

    fn walk(&mut self, i: usize, dt: f64) {
        let mut person = self.people[i];
        if self.time_s >= person.until {
            person.stands = unit(&mut self.random) < 0.3;
            person.until = self.time_s + 1.0 + 9.0 * unit(&mut self.random);
            // Along the aisles, more or less.
            let quarter = libm::floor(4.0 * unit(&mut self.random)) * PI / 2.0;
            person.heading = quarter + 0.2 * (unit(&mut self.random) - 0.5);
            person.pace = PACE.0 + (PACE.1 - PACE.0) * unit(&mut self.random);
        }
        if !person.stands {
            let way = person.pace * dt;
            let (x, y) = (
                person.x + way * libm::cos(person.heading),
                person.y + way * libm::sin(person.heading),
            );
            let (nx, ny) = self.settled(Some(i), x, y, PERSON_RADIUS_M);
            if libm::hypot(nx - person.x, ny - person.y) < 0.3 * way {
                person.until = self.time_s;
            }
            (person.x, person.y) = (nx, ny);
        }
        self.people[i] = person;
    }

    /// Where one of them (the robot if `who` is none) comes to rest that would be at (x, y): there if it is
    /// free, else pushed out of what is in the way, else where it was.
    fn settled(&self, who: Option<usize>, x: f64, y: f64, radius: f64) -> (f64, f64) {
        let was = who.map_or((self.x, self.y), |i| (self.people[i].x, self.people[i].y));
        let (mut x, mut y) = (x, y);
        for _ in 0..4 {
            let mut free = true;
            if let Some((distance, (ax, ay))) = self.floor.nearest(x, y, radius)
                && distance < radius - 1e-6
            {
                (x, y, free) = (x + ax * (radius - distance), y + ay * (radius - distance), false);
            }
            for (ox, oy, other) in self.others(who) {
                let (dx, dy) = (x - ox, y - oy);
                let (distance, meet) = (libm::hypot(dx, dy).max(1e-9), radius + other);
                if distance < meet - 1e-6 {
                    let push = meet / distance;
                    (x, y, free) = (ox + dx * push, oy + dy * push, false);
                }
            }
            if free {
                return (x, y);
            }
        }
        was
    }

    /// Everybody but one, with their radius.
    fn others(&self, who: Option<usize>) -> impl Iterator<Item = (f64, f64, f64)> {
        let robot = who.is_some().then_some((self.x, self.y, ROBOT_RADIUS_M));
        let people = self
            .people
            .iter()
            .enumerate()
            .filter(move |(i, _)| Some(*i) != who);
        robot
            .into_iter()
            .chain(people.map(|(_, p)| (p.x, p.y, PERSON_RADIUS_M)))
    }

    fn touch(&mut self) {
        let solid = self.floor.nearest(self.x, self.y, ROBOT_RADIUS_M + 2.0 * TOUCH.1);
        let solid = solid.map(|(distance, (ax, ay))| (distance - ROBOT_RADIUS_M, (-ax, -ay)));
        for i in 0..self.touching.len() {
            let near = match i.checked_sub(1) {
                None => solid,
                Some(i) => {
                    let (dx, dy) = (self.people[i].x - self.x, self.people[i].y - self.y);
                    let distance = libm::hypot(dx, dy).max(1e-9);
                    let gap = distance - ROBOT_RADIUS_M - PERSON_RADIUS_M;
                    Some((gap, (dx / distance, dy / distance)))
                }
            };
            let gap = near.map_or(f64::INFINITY, |(gap, _)| gap);
            if self.touching[i] || gap > TOUCH.0 {
                self.touching[i] &= gap < TOUCH.1;
                continue;
            }
            self.touching[i] = true;
            self.report.contacts += 1;
            if let Some((_, (ux, uy))) = near {
                let towards = self.moved.map(|(vx, vy)| vx * ux + vy * uy);
                let approach_m_s = towards[0].max(towards[1]);
                if approach_m_s > TOUCH.2 {
                    self.report.caused += 1;
                    self.report.latest = Some(Caused {
                        time_s: self.time_s,
                        person: i.checked_sub(1),
                        approach_m_s,
                    });
                }
            }
        }
    }

    /// Twelve ranges from the rim, m, straight ahead first, counter-clockwise. No echo reads 10 m.
    pub fn sonar(&mut self) -> [f64; SONARS] {
        core::array::from_fn(|i| {
            let axis = self.heading + TAU * i as f64 / SONARS as f64;
            let (lost, error) = (unit(&mut self.noise), 2.0 * unit(&mut self.noise) - 1.0);
            let from = (
                self.x + ROBOT_RADIUS_M * libm::cos(axis),
                self.y + ROBOT_RADIUS_M * libm::sin(axis),
            );
            let mut nearest = f64::INFINITY;
            for ray in 0..CONE.0 {
                let angle = axis + CONE.1 * (ray as f64 / (CONE.0 - 1) as f64 - 0.5);
                nearest = nearest
                    .min(self.floor.ray(from, angle, RANGE_M.1))
                    .min(self.to_person(from, angle));
            }
            if lost < LOST || nearest >= RANGE_M.1 {
                return 10.0;
            }
            let told = nearest * (1.0 + 2.0 * ERROR.0 * error);
            (libm::round(told / ERROR.1) * ERROR.1).max(RANGE_M.0)
        })
    }

    fn to_person(&self, (x, y): (f64, f64), angle: f64) -> f64 {
        let (cos, sin) = (libm::cos(angle), libm::sin(angle));
        let along = |p: &Person| {
            let (dx, dy) = (p.x - x, p.y - y);
            let (ahead, aside) = (dx * cos + dy * sin, dy * cos - dx * sin);
            let inside = PERSON_RADIUS_M * PERSON_RADIUS_M - aside * aside;
            (inside >= 0.0 && ahead > 0.0).then(|| (ahead - libm::sqrt(inside)).max(0.0))
        };
        self.people.iter().filter_map(along).fold(f64::INFINITY, f64::min)
    }

    /// Where wheels and compass believe the robot is: m, m, rad.
    pub fn believed(&self) -> (f64, f64, f64) {
        (
            self.counted.0,
            self.counted.1,
            wrapped(self.heading + self.compass_off),
        )
    }

    /// What an observer may know.
    pub fn report(&self) -> Report {
        self.report
    }

    /// The floor.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Where everybody is, m, and which way they face, rad.
    pub fn people(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.people.iter().map(|p| (p.x, p.y, p.heading))
    }
}

fn wrapped(angle: f64) -> f64 {
    angle - TAU * libm::floor((angle + PI) / TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_ever_in_a_rack_or_in_another() {
        for seed in 1..=3 {
            let mut world = Warehouse::new(seed, 6, false);
            for step in 0..10_000 {
                world.step(0.02, 0.3, if step % 400 < 100 { 1.0 } else { 0.0 });
                let robot = (world.x, world.y, ROBOT_RADIUS_M);
                let everybody = std::iter::once(robot).chain(world.others(None));
                for (x, y, radius) in everybody {
                    assert!(
                        world.floor.nearest(x, y, radius - 0.01).is_none(),
                        "seed {seed}: in a rack"
                    );
                }
            }
            assert!(world.report.travelled_m > 10.0, "{:?}", world.report);
            assert!(world.report.caused > 0, "a blind robot drives into something");
        }
    }

    #[test]
    fn a_seed_is_a_run() {
        let run = |seed| {
            let mut world = Warehouse::new(seed, 6, false);
            (0..2000).for_each(|_| world.step(0.02, 0.2, 0.1));
            (world.report(), world.sonar())
        };
        assert_eq!(run(4), run(4));
        assert_ne!(run(4), run(5));
    }
}
