//! The office as a whole: one step moves the robots, then the people, then looks at what touches.

use crate::camera::{CameraModel, STRIPS, fan};
use crate::config::{Config, Drive, PEOPLE_MAX, PERSON_RADIUS_M, Pose, ROBOT_RADIUS_M, ROBOTS_MAX};
use crate::contacts::{Contacts, Touch};
use crate::discs::{Disc, settled};
use crate::fittings::Fittings;
use crate::layout::{Layout, Room};
use crate::noise::{Noise, Use};
use crate::people::{GROUP, Person, Surroundings, starting_place};
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

/// A robot with what it senses by.
struct Inmate {
    robot: Robot,
    touch: Touch,
    sonar_noise: Noise,
    camera_noise: Noise,
    sonar: [f64; SONARS],
}

/// A running office with the robot in it, or several.
///
/// After [`Office::new`] neither [`Office::sonar`] nor the small read-outs allocate, nor does
/// [`Office::step`] unless a door or a chair moves; [`Office::view`], [`Office::floor_plan`] and
/// [`Office::place_person`] do.
pub struct Office {
    layout: Layout,
    sonar_model: SonarModel,
    camera_model: CameraModel,
    space: Space,
    ways: Ways,
    fittings: Fittings,
    inmates: Vec<Inmate>,
    people: Vec<Person>,
    /// The robots' names, then the people's.
    names: Vec<Arc<str>>,
    /// The robots, then the people.
    discs: Vec<Disc>,
    people_noise: Noise,
    time_s: f64,
}

/// Every kind of person with how many there are of it.
fn crowd(config: &Config) -> [(PersonKind, &'static str, u32); 4] {
    [
        (PersonKind::Walker, "walker", config.people),
        (PersonKind::Attacker, "attacker", config.attackers),
        (PersonKind::Cornerer, "cornerer", config.cornerers),
        (PersonKind::Talker, "talker", config.talkers),
    ]
}

impl Office {
    /// Builds the office and puts everybody in their place; people for whom there is no room, on the floor or
    /// within [`PEOPLE_MAX`], stay outside.
    ///
    /// # Panics
    /// If a robot would start inside something, or if there are more than [`ROBOTS_MAX`] robots.
    pub fn new(config: &Config) -> Self {
        assert!(config.others.len() < ROBOTS_MAX, "more than {ROBOTS_MAX} robots");
        let mut space = Space::new(&config.layout);
        space.open_all_leaves(&config.layout);
        let ways = Ways::new(&config.layout, &space);
        let first = config.start.unwrap_or(config.layout.start);
        let starts: Vec<_> = std::iter::once(first)
            .chain(config.others.iter().copied())
            .collect();
        let mut office = Office {
            layout: config.layout.clone(),
            sonar_model: config.sonar,
            camera_model: config.camera,
            fittings: Fittings::new(
                config.fittings,
                &config.layout,
                Noise::new(config.seed, Use::Fittings),
            ),
            inmates: Vec::new(),
            people: Vec::with_capacity(PEOPLE_MAX),
            names: Vec::with_capacity(ROBOTS_MAX + PEOPLE_MAX),
            discs: Vec::with_capacity(ROBOTS_MAX + PEOPLE_MAX),
            people_noise: Noise::new(config.seed, Use::People),
            space,
            ways,
            time_s: 0.0,
        };
        for start in starts {
            office.put_robot(config, start);
        }
        for (kind, name, count) in crowd(config) {
            for number in 0..count as usize {
                office.put_person(kind, name, number);
            }
        }
        office
    }

    fn put_robot(&mut self, config: &Config, start: (f64, f64, f64)) {
        let index = self.inmates.len();
        let at = vec2(start.0, start.1);
        let clear = self.space.nearest(at, ROBOT_RADIUS_M - 0.0005).is_none();
        assert!(clear, "the robot starts inside something at {start:?}");
        let noise = |purpose| Noise::of(config.seed, purpose, index);
        let robot = Robot::new(config.base, config.odometry, start, noise(Use::Odometry));
        self.discs.push(robot.disc());
        self.names.push(format!("robot {}", index + 1).into());
        self.inmates.push(Inmate {
            robot,
            touch: Touch::new(index, self.space.things(), ROBOTS_MAX + PEOPLE_MAX),
            sonar_noise: noise(Use::Sonar),
            camera_noise: noise(Use::Camera),
            sonar: [0.0; SONARS],
        });
    }

    fn put_person(&mut self, kind: PersonKind, name: &str, number: usize) {
        if self.people.len() >= PEOPLE_MAX {
            return;
        }
        let (size, robots) = ((self.layout.width, self.layout.height), self.inmates.len());
        let noise = &mut self.people_noise;
        let at = starting_place(&self.space, &self.ways, size, &self.discs, robots, noise);
        let Some(at) = at else { return };
        let (index, prey) = (self.discs.len(), number % robots);
        let group = (number / GROUP, number % GROUP);
        self.people
            .push(Person::new(kind, (index, prey), group, at, noise));
        self.discs.push(Disc {
            at,
            radius: PERSON_RADIUS_M,
        });
        self.names.push(format!("{name} {}", number + 1).into());
    }

    /// Lets `dt_s` seconds pass with the robot under `command`; other robots stand.
    ///
    /// # Panics
    /// If `dt_s` is not within 0 to 0.05 s.
    pub fn step(&mut self, dt_s: f64, command: Drive) {
        self.step_all(dt_s, &[command]);
    }

    /// Lets `dt_s` seconds pass with each robot under its command; one without a command stands.
    ///
    /// # Panics
    /// If `dt_s` is not within 0 to 0.05 s.
    pub fn step_all(&mut self, dt_s: f64, commands: &[Drive]) {
        assert!(
            dt_s > 0.0 && dt_s <= STEP_S_MAX,
            "a step of {dt_s} s is not within 0 to {STEP_S_MAX} s"
        );
        self.time_s += dt_s;
        for (index, inmate) in self.inmates.iter_mut().enumerate() {
            let wanted = inmate
                .robot
                .drive(dt_s, commands.get(index).copied().unwrap_or_default());
            let now = settled(&self.space, &self.discs, index, wanted);
            inmate.robot.settle(dt_s, now);
            self.discs[index] = inmate.robot.disc();
        }
        let robots = self.inmates.len();
        for index in 0..self.people.len() {
            let around = Surroundings {
                space: &self.space,
                ways: &self.ways,
                discs: &self.discs,
                robots,
                time_s: self.time_s,
                dt_s,
            };
            let at = self.people[index].step(&around, &mut self.people_noise);
            self.discs[robots + index].at = at;
        }
        self.fittings.step(
            self.time_s,
            &mut self.layout,
            &mut self.space,
            &self.ways,
            &self.discs,
            robots,
        );
        for Inmate { robot, touch, .. } in &mut self.inmates {
            touch.look(self.time_s, robot, &self.space, &self.discs, &self.names);
        }
    }

    /// Fires the ring: twelve ranges, m from the robot's rim. Index i looks i × 30 degrees
    /// counter-clockwise from straight ahead. No echo reads as the model's farthest range. The
    /// noise comes from a stream of its own: how often this is called never changes the world.
    pub fn sonar(&mut self) -> [f64; SONARS] {
        self.sonar_of(0)
    }

    /// [`Office::sonar`] of one of several robots, counted from 0.
    pub fn sonar_of(&mut self, robot: usize) -> [f64; SONARS] {
        let inmate = &mut self.inmates[robot];
        let air = Air {
            model: &self.sonar_model,
            space: &self.space,
            discs: &self.discs,
            own: robot,
        };
        let heading = inmate.robot.heading;
        inmate.sonar = air.ring(self.discs[robot], heading, &mut inmate.sonar_noise);
        inmate.sonar
    }

    /// Takes a picture with a robot's range camera: twelve free distances, m from the robot's middle, the
    /// leftmost strip first. The noise has a stream of its own.
    pub fn fan_of(&mut self, robot: usize) -> [f64; STRIPS] {
        let inmate = &mut self.inmates[robot];
        let air = Air {
            model: &self.sonar_model,
            space: &self.space,
            discs: &self.discs,
            own: robot,
        };
        fan(
            &air,
            &self.camera_model,
            self.discs[robot],
            inmate.robot.heading,
            &mut inmate.camera_noise,
        )
    }

    /// How many robots there are.
    pub fn robots(&self) -> usize {
        self.inmates.len()
    }

    /// Where the wheels and the compass believe the robot is. It starts at the true place; the
    /// position strays with the way driven and when the base is held while the wheels turn, the
    /// heading stays within the compass's error.
    pub fn odometry(&self) -> Pose {
        self.odometry_of(0)
    }

    /// [`Office::odometry`] of one of several robots.
    pub fn odometry_of(&self, robot: usize) -> Pose {
        self.inmates[robot].robot.believed_pose()
    }

    /// Where the robot is; for observers and tests, never for a layer.
    pub fn true_pose(&self) -> Pose {
        self.true_pose_of(0)
    }

    /// [`Office::true_pose`] of one of several robots.
    pub fn true_pose_of(&self, robot: usize) -> Pose {
        self.inmates[robot].robot.pose()
    }

    /// Every other robot and every person: the name, and where the middle is, m. For observers and tests.
    pub fn others_of(&self, robot: usize) -> impl Iterator<Item = (&str, f64, f64)> {
        let all = self.names.iter().zip(&self.discs).enumerate();
        all.filter(move |(index, _)| *index != robot)
            .map(|(_, (name, disc))| (&**name, disc.at.x, disc.at.y))
    }

    /// What has touched the robot so far.
    pub fn contacts(&self) -> &Contacts {
        self.contacts_of(0)
    }

    /// [`Office::contacts`] of one of several robots.
    pub fn contacts_of(&self, robot: usize) -> &Contacts {
        &self.inmates[robot].touch.contacts
    }

    /// s since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The rooms, in so far as the layout tells them apart.
    pub fn rooms(&self) -> &[Room] {
        &self.layout.rooms
    }

    /// Smallest distance from the robot's rim to anything, m; zero when something touches it.
    pub fn clearance_m(&self) -> f64 {
        let robot = self.discs[0];
        let others = self.discs[1..]
            .iter()
            .map(|disc| robot.gap(disc))
            .fold(f64::INFINITY, f64::min);
        // Look close by first; the whole floor only when nothing is there.
        let whole_floor = self.layout.width + self.layout.height;
        let near = [1.0, whole_floor]
            .iter()
            .find_map(|&reach| self.space.nearest(robot.at, reach));
        let solid = near.map_or(f64::INFINITY, |near| near.distance - robot.radius);
        others.min(solid).max(0.0)
    }

    /// Length of the way that the robot has really gone, m.
    pub fn distance_travelled_m(&self) -> f64 {
        self.distance_travelled_of_m(0)
    }

    /// [`Office::distance_travelled_m`] of one of several robots.
    pub fn distance_travelled_of_m(&self, robot: usize) -> f64 {
        self.inmates[robot].robot.travelled
    }

    /// Walls and furniture as they stand, for a page.
    pub fn floor_plan(&self) -> FloorPlan {
        let blocks = self.layout.blocks.iter().enumerate();
        FloorPlan {
            name: self.layout.name.clone(),
            width: self.layout.width,
            height: self.layout.height,
            robot_radius: ROBOT_RADIUS_M,
            person_radius: PERSON_RADIUS_M,
            blocks: blocks
                .filter(|(index, _)| self.space.is_there(*index))
                .map(|(_, block)| block.clone())
                .collect(),
            places: self.layout.places.clone(),
        }
    }

    /// The office at this moment, for a page.
    pub fn view(&self) -> View {
        let first = &self.inmates[0];
        let people = self.people.iter().zip(&self.discs[self.inmates.len()..]);
        View {
            time_s: self.time_s,
            robot: first.robot.pose(),
            odometry: first.robot.believed_pose(),
            sonar: first.sonar,
            robots: self.inmates[1..].iter().map(|i| i.robot.pose()).collect(),
            people: people
                .map(|(person, Disc { at, .. })| PersonView {
                    kind: person.kind,
                    x: at.x,
                    y: at.y,
                    heading: person.heading,
                })
                .collect(),
            contacts: first.touch.contacts.all,
            contacts_caused: first.touch.contacts.caused,
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
        self.people.push(Person::scripted(self.discs.len(), at, velocity));
        self.discs.push(disc);
        self.names.push(format!("scripted {}", self.people.len()).into());
    }
}
