//! The office as a whole: one step moves the robot, then the people, then looks at what touches.

use crate::config::{Config, Drive, PEOPLE_MAX, PERSON_RADIUS_M, Pose, ROBOT_RADIUS_M};
use crate::contacts::{Contacts, Touch};
use crate::discs::{Disc, settled};
use crate::layout::Layout;
use crate::noise::{Noise, Use};
use crate::people::{Person, Surroundings, starting_place};
use crate::plane::{Vec2, vec2};
use crate::robot::Robot;
use crate::sonar::{Air, SONARS, SonarModel};
use crate::space::Space;
use crate::view::{FloorPlan, PersonKind, PersonView, View};
use crate::ways::Ways;
use std::sync::Arc;

/// Longest step, s: in it nobody moves farther than a wall is thick.
const STEP_S_MAX: f64 = 0.05;
/// Fastest that a scripted person may walk, m/s, so that [`STEP_S_MAX`] holds for them as well.
const SCRIPTED_M_S_MAX: f64 = 2.0;

/// A running office with the robot in it.
///
/// After [`Office::new`] neither [`Office::step`] nor [`Office::sonar`] nor the small read-outs
/// allocate; [`Office::view`], [`Office::floor_plan`] and [`Office::place_person`] do.
pub struct Office {
    layout: Layout,
    sonar_model: SonarModel,
    space: Space,
    ways: Ways,
    robot: Robot,
    people: Vec<Person>,
    names: Vec<Arc<str>>,
    /// The robot, then the people.
    discs: Vec<Disc>,
    touch: Touch,
    sonar_noise: Noise,
    people_noise: Noise,
    sonar: [f64; SONARS],
    time_s: f64,
}

impl Office {
    /// Builds the office and puts everybody in their place.
    ///
    /// # Panics
    /// If the robot would start inside something, if there are more than [`PEOPLE_MAX`] people, or
    /// if there is no room on the floor for all of them.
    pub fn new(config: &Config) -> Self {
        let count = config.people as usize + config.attackers as usize;
        assert!(count <= PEOPLE_MAX, "{count} people are more than {PEOPLE_MAX}");
        let space = Space::new(&config.layout);
        let ways = Ways::new(&config.layout, &space);
        let start = config.start.unwrap_or(config.layout.start);
        let start_disc = Disc {
            at: vec2(start.0, start.1),
            radius: ROBOT_RADIUS_M,
        };
        let clear = space.nearest(start_disc.at, ROBOT_RADIUS_M - 0.0005).is_none();
        assert!(clear, "the robot starts inside something at {start:?}");
        let mut people_noise = Noise::new(config.seed, Use::People);
        let mut discs = Vec::with_capacity(1 + PEOPLE_MAX);
        discs.push(start_disc);
        let (mut people, mut names) = (Vec::with_capacity(PEOPLE_MAX), Vec::with_capacity(PEOPLE_MAX));
        for i in 0..count {
            let walker = i < config.people as usize;
            let size = (config.layout.width, config.layout.height);
            let at = starting_place(&space, &ways, size, &discs, &mut people_noise);
            let at = at.unwrap_or_else(|| panic!("no room on the floor for person {i}"));
            let kind = if walker {
                PersonKind::Walker
            } else {
                PersonKind::Attacker
            };
            discs.push(Disc {
                at,
                radius: PERSON_RADIUS_M,
            });
            people.push(Person::new(kind, i + 1, at, &mut people_noise));
            let number = if walker {
                i + 1
            } else {
                i + 1 - config.people as usize
            };
            names.push(format!("{} {number}", if walker { "walker" } else { "attacker" }).into());
        }
        Office {
            layout: config.layout.clone(),
            sonar_model: config.sonar,
            robot: Robot::new(
                config.base,
                config.odometry,
                start,
                Noise::new(config.seed, Use::Odometry),
            ),
            touch: Touch::new(space.things(), PEOPLE_MAX),
            space,
            ways,
            people,
            names,
            discs,
            sonar_noise: Noise::new(config.seed, Use::Sonar),
            people_noise,
            sonar: [0.0; SONARS],
            time_s: 0.0,
        }
    }

    /// Lets `dt_s` seconds pass with the robot under `command`.
    ///
    /// # Panics
    /// If `dt_s` is not within 0 to 0.05 s.
    pub fn step(&mut self, dt_s: f64, command: Drive) {
        assert!(
            dt_s > 0.0 && dt_s <= STEP_S_MAX,
            "a step of {dt_s} s is not within 0 to {STEP_S_MAX} s"
        );
        self.time_s += dt_s;
        let wanted = self.robot.drive(dt_s, command);
        let now = settled(&self.space, &self.discs, 0, wanted);
        self.robot.settle(dt_s, now);
        self.discs[0] = self.robot.disc();
        for index in 0..self.people.len() {
            let around = Surroundings {
                space: &self.space,
                ways: &self.ways,
                discs: &self.discs,
                time_s: self.time_s,
                dt_s,
            };
            let at = self.people[index].step(&around, &mut self.people_noise);
            self.discs[index + 1].at = at;
        }
        self.touch
            .look(self.time_s, &self.robot, &self.space, &self.discs, &self.names);
    }

    /// Fires the ring: twelve ranges, m from the robot's rim. Index i looks i × 30 degrees
    /// counter-clockwise from straight ahead. No echo reads as the model's farthest range. The
    /// noise comes from a stream of its own: how often this is called never changes the world.
    pub fn sonar(&mut self) -> [f64; SONARS] {
        let air = Air {
            model: &self.sonar_model,
            space: &self.space,
            people: &self.discs[1..],
        };
        self.sonar = air.ring(self.discs[0], self.robot.heading, &mut self.sonar_noise);
        self.sonar
    }

    /// Where the wheels and the compass believe the robot is. It starts at the true place; the
    /// position strays with the way driven and when the base is held while the wheels turn, the
    /// heading stays within the compass's error.
    pub fn odometry(&self) -> Pose {
        self.robot.believed_pose()
    }

    /// Where the robot is; for observers and tests, never for a layer.
    pub fn true_pose(&self) -> Pose {
        self.robot.pose()
    }

    /// What has touched the robot so far.
    pub fn contacts(&self) -> &Contacts {
        &self.touch.contacts
    }

    /// s since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Smallest distance from the robot's rim to anything, m; zero when something touches it.
    pub fn clearance_m(&self) -> f64 {
        let robot = self.discs[0];
        let people = self.discs[1..]
            .iter()
            .map(|disc| robot.gap(disc))
            .fold(f64::INFINITY, f64::min);
        // Look close by first; the whole floor only when nothing is there.
        let whole_floor = self.layout.width + self.layout.height;
        let near = [1.0, whole_floor]
            .iter()
            .find_map(|&reach| self.space.nearest(robot.at, reach));
        let solid = near.map_or(f64::INFINITY, |near| near.distance - robot.radius);
        people.min(solid).max(0.0)
    }

    /// Length of the way that the robot has really gone, m.
    pub fn distance_travelled_m(&self) -> f64 {
        self.robot.travelled
    }

    /// What never moves, for a page; fetch it once.
    pub fn floor_plan(&self) -> FloorPlan {
        FloorPlan {
            name: self.layout.name.clone(),
            width: self.layout.width,
            height: self.layout.height,
            robot_radius: ROBOT_RADIUS_M,
            person_radius: PERSON_RADIUS_M,
            blocks: self.layout.blocks.clone(),
            places: self.layout.places.clone(),
        }
    }

    /// The office at this moment, for a page.
    pub fn view(&self) -> View {
        let people = self.people.iter().zip(&self.discs[1..]);
        View {
            time_s: self.time_s,
            robot: self.robot.pose(),
            odometry: self.robot.believed_pose(),
            sonar: self.sonar,
            people: people
                .map(|(person, Disc { at, .. })| PersonView {
                    kind: person.kind,
                    x: at.x,
                    y: at.y,
                    heading: person.heading,
                })
                .collect(),
            contacts: self.touch.contacts.all,
            contacts_caused: self.touch.contacts.caused,
        }
    }

    /// Puts a person at (`x`, `y`) m who walks on a straight line at (`vx`, `vy`) m/s and never
    /// looks; what is in the way stops them or makes them slide along it. For tests.
    ///
    /// # Panics
    /// If the place is taken, the speed above 2 m/s, or the office full.
    pub fn place_person(&mut self, x: f64, y: f64, vx: f64, vy: f64) {
        assert!(self.people.len() < PEOPLE_MAX, "the office is full");
        let (at, velocity): (Vec2, Vec2) = (vec2(x, y), vec2(vx, vy));
        assert!(
            velocity.length() <= SCRIPTED_M_S_MAX,
            "nobody walks at {} m/s",
            velocity.length()
        );
        let disc = Disc {
            at,
            radius: PERSON_RADIUS_M,
        };
        let free = self.discs.iter().all(|other| disc.gap(other) >= 0.0)
            && self.space.nearest(at, PERSON_RADIUS_M - 0.0005).is_none();
        assert!(free, "({x}, {y}) is taken");
        self.discs.push(disc);
        self.people
            .push(Person::scripted(self.people.len() + 1, at, velocity));
        self.names.push(format!("scripted {}", self.people.len()).into());
    }
}
