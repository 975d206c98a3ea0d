//! The belief: what the robot makes of what its sensors say, in the same terms as the world it stands in.
//!
//! A belief is a [`World`] that never lives a beat: places, fuel and things are what was sensed last, and what
//! the robot remembers (obstacles a while, look-outs visited, the site) is kept here.
//!
//! Must never: allocate once it is made.

use super::eyes::Seen;
use super::geometry::Point;
use super::person::Person;
use super::robot::Robot;
use super::wired::{Sensed, TOLD_MAX, Told};
use super::world::{Disc, Site, World};

/// Room for everything that the eyes can tell at once, and for obstacles that stay before them a while.
const ROOM: usize = 64;
/// Obstacles whose places differ by less than this are one, metres.
const SAME_PLACE_M: f64 = 0.05;
/// Radius of a person, metres.
const PERSON_M: f64 = 0.25;
/// Numbers that obstacles get here begin with this; no thing of a world has them.
const FIRST_OBSTACLE: u32 = 1 << 24;

fn here(list: &[Told]) -> impl Iterator<Item = (u32, Point)> {
    let there = list.iter().filter(|told| told.number != 0);
    there.map(|told| (told.number, told.place))
}

impl World {
    /// A belief about nothing yet, with room for all that can come.
    pub(super) fn belief(wanted: usize) -> Self {
        let mut belief = Self::new(Robot::new(Point::default(), 0.0), 0);
        belief.wanted = wanted;
        belief.planning = false;
        belief.seen = Seen::with_room(ROOM);
        belief.robot.map.make_room();
        belief.sites.reserve(TOLD_MAX);
        belief.persons.reserve(TOLD_MAX);
        belief.obstacles.reserve(ROOM);
        belief
    }

    /// A belief about nothing again, in the same room.
    pub(super) fn forget_all(&mut self) {
        self.seen.clear();
        let mut map = std::mem::take(&mut self.robot.map);
        map.forget();
        self.robot = Robot::new(Point::default(), 0.0);
        self.robot.map = map;
        self.sites.clear();
        self.persons.clear();
        self.obstacles.clear();
        self.ordered_until_s = f64::NEG_INFINITY;
        self.interrupt = true;
    }

    /// Takes in what the sensors say.
    pub(super) fn believe(&mut self, sensed: &Sensed) {
        self.now_s = sensed.now_s;
        let robot = &mut self.robot;
        robot.place = sensed.place;
        robot.heading_rad = sensed.heading_rad;
        robot.steering_rad = sensed.steering_rad;
        robot.arm_rad = sensed.arm_rad;
        robot.arm_m = sensed.arm_m;
        robot.held = (sensed.held != 0).then_some(sensed.held);
        robot.fuel = sensed.fuel;
        robot.filling = sensed.filling;
        // A bump is over when the robot has backed off, not when the contact ends.
        robot.bumped |= sensed.bumped;
        self.cold = sensed.cold;
        self.whistle = sensed.whistle;
        self.red_light = sensed.red_light;
        let ordered = self.ordered();
        self.ordered_until_s = if sensed.ordered {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        self.interrupt |= sensed.ordered && !ordered;
        self.believe_eyes(sensed);
        self.believe_site(sensed);
        self.remember_round();
    }

    fn believe_eyes(&mut self, sensed: &Sensed) {
        let mut seen = std::mem::take(&mut self.seen);
        let stations_before = seen.stations.len();
        seen.renew(here(&sensed.objects), here(&sensed.stations), self.now_s);
        for told in sensed.obstacles.iter().filter(|told| told.number != 0) {
            let disc = self.known(told);
            seen.keep_standing(disc, self.now_s);
            self.robot.map.add(disc.id, disc.place, disc.radius_m);
        }
        self.persons.clear();
        for (id, place) in here(&sensed.persons) {
            let disc = Disc {
                id,
                place,
                radius_m: PERSON_M,
            };
            seen.keep_walking(disc, self.now_s);
            self.persons.push(Person::standing(id, place, PERSON_M));
        }
        self.interrupt |= seen.has_new() || seen.stations.len() > stations_before;
        self.seen = seen;
    }

    /// The obstacle that was told, under the number it has here.
    fn known(&mut self, told: &Told) -> Disc {
        let same = |disc: &&Disc| disc.place.distance_m(told.place) < SAME_PLACE_M;
        if let Some(disc) = self.obstacles.iter().find(same) {
            return *disc;
        }
        let new = Disc {
            id: FIRST_OBSTACLE + self.next_id,
            place: told.place,
            radius_m: f64::from(told.number) / 1e3,
        };
        if self.obstacles.len() < ROOM {
            self.next_id += 1;
            self.obstacles.push(new);
        }
        new
    }

    fn believe_site(&mut self, sensed: &Sensed) {
        let Told { number, place } = sensed.site;
        self.seen.site = (number != 0).then_some(number);
        if number == 0 {
            return;
        }
        if self.robot.site.is_none() {
            self.sites.push(Site {
                id: number,
                place,
                proper: true,
            });
            self.robot.site = Some(number);
            self.interrupt = true;
        }
        if self.robot.site == Some(number) {
            self.robot.counted = sensed.lying as usize;
        }
    }
}
