//! The eyes: limited in range and angle, and an obstacle hides what is behind it.

use super::geometry::{Point, between_rad, distance_to_segment_m};
use super::robot::{EYES_RANGE_M, EYES_SIDE_RAD};
use super::world::{Disc, NEST_RADIUS_M, World};

/// The robot feels what is within this distance of its middle without seeing it, metres.
const TOUCH_M: f64 = 0.9;
/// How long an obstacle stays before the eyes after it left the view, seconds: longer than turning around
/// takes, or the robot would forget what it turns away from and turn back.
const AFTERIMAGE_S: f64 = 6.0;
/// The same for a person, who will not stay there.
const MOVING_AFTERIMAGE_S: f64 = 1.0;

/// What the eyes see now. The lists keep their room from beat to beat.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    /// Objects outside the nest and the hand.
    pub(crate) objects: Vec<(u32, Point)>,
    /// Objects seen in the beat before.
    before: Vec<u32>,
    pub(crate) stations: Vec<(u32, Point)>,
    /// Obstacles and persons, and until when each stays before the eyes, seconds.
    pub(crate) obstacles: Vec<(Disc, f64)>,
    /// A place that meets the criteria of a nest site.
    pub(crate) site: Option<u32>,
    /// The robot's own nest is in view.
    pub(crate) nest: bool,
}

impl Seen {
    /// Eyes with room for so many things of each sort.
    pub(super) fn with_room(room: usize) -> Self {
        Self {
            objects: Vec::with_capacity(room),
            before: Vec::with_capacity(room),
            stations: Vec::with_capacity(room),
            obstacles: Vec::with_capacity(room),
            site: None,
            nest: false,
        }
    }

    /// Sees nothing.
    pub(super) fn clear(&mut self) {
        self.objects.clear();
        self.before.clear();
        self.stations.clear();
        self.obstacles.clear();
        self.site = None;
        self.nest = false;
    }

    /// Sees other objects and stations, and forgets obstacles that left the view long ago.
    pub(super) fn renew(
        &mut self,
        objects: impl Iterator<Item = (u32, Point)>,
        stations: impl Iterator<Item = (u32, Point)>,
        now_s: f64,
    ) {
        self.before.clear();
        self.before.extend(self.objects.iter().map(|&(id, _)| id));
        self.objects.clear();
        self.objects.extend(objects);
        self.stations.clear();
        self.stations.extend(stations);
        self.obstacles.retain(|&(_, until_s)| until_s > now_s);
    }

    /// Whether there is an object that was not there before.
    pub(super) fn has_new(&self) -> bool {
        self.objects.iter().any(|(id, _)| !self.before.contains(id))
    }

    /// Sees an obstacle; as many as there is room for.
    pub(super) fn keep_standing(&mut self, disc: Disc, now_s: f64) {
        self.keep_in_room(disc, now_s + AFTERIMAGE_S);
    }

    /// Sees a person.
    pub(super) fn keep_walking(&mut self, disc: Disc, now_s: f64) {
        self.keep_in_room(disc, now_s + MOVING_AFTERIMAGE_S);
    }

    fn keep_in_room(&mut self, disc: Disc, until_s: f64) {
        let known = self.obstacles.iter().any(|(known, _)| known.id == disc.id);
        if known || self.obstacles.len() < self.obstacles.capacity() {
            self.keep(disc, until_s);
        }
    }

    fn keep(&mut self, disc: Disc, until_s: f64) {
        match self.obstacles.iter_mut().find(|(known, _)| known.id == disc.id) {
            Some(known) => *known = (disc, until_s),
            None => self.obstacles.push((disc, until_s)),
        }
    }
}

impl World {
    /// Whether the eyes see a place; `hidden_by_others_than` names an obstacle that does not hide itself.
    pub(super) fn sees(&self, place: Point, hidden_by_others_than: Option<u32>) -> bool {
        let robot = &self.robot;
        let distance_m = robot.place.distance_m(place);
        if distance_m <= TOUCH_M {
            return true;
        }
        let side_rad = between_rad(robot.heading_rad, robot.place.direction_rad(place));
        distance_m <= EYES_RANGE_M
            && side_rad.abs() <= EYES_SIDE_RAD
            && self.obstacles.iter().all(|disc| {
                Some(disc.id) == hidden_by_others_than
                    || distance_to_segment_m(disc.place, robot.place, place) > disc.radius_m
            })
    }

    /// Whether the eyes see the near side of an obstacle now.
    pub(super) fn in_view(&self, disc: &Disc) -> bool {
        let near = disc
            .place
            .towards(disc.place.direction_rad(self.robot.place), disc.radius_m);
        self.sees(near, Some(disc.id))
    }

    /// Looks around; something new in view is a priority interrupt.
    pub(crate) fn look(&mut self) {
        let mut seen = std::mem::take(&mut self.seen);
        let nest = self.known_site().map(|site| site.place);
        seen.before.clear();
        seen.before.extend(seen.objects.iter().map(|&(id, _)| id));
        seen.objects.clear();
        for object in &self.objects {
            let built = nest.is_some_and(|nest| object.place.distance_m(nest) <= NEST_RADIUS_M);
            if Some(object.id) != self.robot.held && !built && self.sees(object.place, None) {
                seen.objects.push((object.id, object.place));
            }
        }
        let stations_before = seen.stations.len();
        seen.stations.clear();
        for station in &self.stations {
            if self.sees(station.place, None) {
                seen.stations.push((station.id, station.place));
            }
        }
        let now_s = self.now_s;
        seen.obstacles.retain(|&(_, until_s)| until_s > now_s);
        for disc in &self.obstacles {
            if self.in_view(disc) {
                seen.keep(*disc, now_s + AFTERIMAGE_S);
                self.robot.map.add(disc.id, disc.place, disc.radius_m);
            }
        }
        for person in &self.persons {
            if self.sees(person.place, None) {
                let disc = Disc {
                    id: person.id,
                    place: person.place,
                    radius_m: person.radius_m,
                };
                seen.keep(disc, now_s + MOVING_AFTERIMAGE_S);
            }
        }
        seen.site = self
            .sites
            .iter()
            .find(|site| site.proper && self.sees(site.place, None))
            .map(|site| site.id);
        seen.nest = nest.is_some_and(|nest| self.sees(nest, None));
        self.interrupt |= seen.has_new() || seen.stations.len() > stations_before;
        self.seen = seen;
    }
}
