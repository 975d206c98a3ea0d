//! Persons: they walk from place to place, put objects down and take them away.

use rand::RngExt;
use serde::Serialize;

use super::geometry::Point;
use super::robot::RADIUS_M;
use super::world::{BEAT_S, FLOOR_X_M, FLOOR_Y_M, Object, World};

/// Walking speed, metres a second.
const WALK_M_S: f64 = 0.4;
/// A person stops this far from the robot's edge, metres.
const POLITE_M: f64 = 0.35;
/// Kept from the walls, metres.
const WALLS_M: f64 = 1.0;
/// Kept from everything else by what a person puts down, metres.
const ROOM_M: f64 = 0.6;

/// A person.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Person {
    /// Number of the thing.
    pub id: u32,
    /// Where the person stands.
    pub place: Point,
    /// Room the person takes, metres.
    pub radius_m: f64,
    /// Where the person goes.
    pub to: Point,
    /// Between one act and the next, seconds on average; infinite for someone who only walks.
    pub act_every_s: f64,
    /// An object the person carries away, to be put down elsewhere.
    pub carries: bool,
}

impl Person {
    /// Someone who is only seen standing there.
    pub(super) fn standing(id: u32, place: Point, radius_m: f64) -> Self {
        Self {
            id,
            place,
            radius_m,
            to: place,
            act_every_s: f64::INFINITY,
            carries: false,
        }
    }
}

impl World {
    pub(crate) fn move_persons(&mut self) {
        for place in 0..self.persons.len() {
            let mut person = self.persons[place];
            let step = person
                .place
                .towards(person.place.direction_rad(person.to), WALK_M_S * BEAT_S);
            let polite = step.distance_m(self.robot.place) > RADIUS_M + person.radius_m + POLITE_M;
            let clear = self
                .obstacles
                .iter()
                .all(|disc| step.distance_m(disc.place) > disc.radius_m + person.radius_m);
            if polite && clear {
                person.place = step;
            }
            if !clear || !polite || person.place.distance_m(person.to) < WALK_M_S {
                person.to = self.somewhere();
            }
            if self.random.random::<f64>() * person.act_every_s < BEAT_S {
                self.act(&mut person);
            }
            self.persons[place] = person;
        }
    }

    /// Takes the nearest object that nobody builds with, or puts the one that was taken down.
    fn act(&mut self, person: &mut Person) {
        let nest = self.known_site().map(|site| site.place);
        if person.carries {
            let place = person.place;
            if self.free_spot(place) {
                self.put_object(place);
                person.carries = false;
            }
            return;
        }
        let held = self.robot.held;
        let loose = |object: &Object| {
            Some(object.id) != held
                && nest.is_none_or(|nest| object.place.distance_m(nest) > 1.0)
                && object.place.distance_m(person.place) < 1.5
        };
        if let Some(found) = self.objects.iter().position(loose) {
            self.objects.remove(found);
            person.carries = true;
        }
    }

    /// Whether the robot could get at an object there.
    pub(crate) fn free_spot(&self, place: Point) -> bool {
        let inside = |at: f64, size: f64| at > WALLS_M && at < size - WALLS_M;
        inside(place.x_m, FLOOR_X_M)
            && inside(place.y_m, FLOOR_Y_M)
            && self
                .obstacles
                .iter()
                .all(|disc| place.distance_m(disc.place) > disc.radius_m + ROOM_M)
    }

    fn somewhere(&mut self) -> Point {
        let x_m = self.random.random_range(WALLS_M..FLOOR_X_M - WALLS_M);
        let y_m = self.random.random_range(WALLS_M..FLOOR_Y_M - WALLS_M);
        Point::new(x_m, y_m)
    }
}
