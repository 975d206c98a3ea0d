//! What someone outside can do to the world while it runs; each is a priority interrupt when the robot sees it.

use super::geometry::Point;
use super::person::Person;
use super::world::{Disc, Object, Site, Station, World};

impl World {
    fn new_id(&mut self) -> u32 {
        let id = self.next_id;
        self.next_id += 1;
        id
    }

    /// Puts an object down and tells its number.
    pub fn put_object(&mut self, place: Point) -> u32 {
        let id = self.new_id();
        self.objects.push(Object { id, place });
        id
    }

    /// Takes an object away; `false` if it is not there or in the robot's hand.
    pub fn take_object(&mut self, id: u32) -> bool {
        let before = self.objects.len();
        let held = self.robot.held;
        self.objects.retain(|object| object.id != id || held == Some(id));
        self.objects.len() < before
    }

    /// Puts up an obstacle and tells its number.
    pub fn put_obstacle(&mut self, place: Point, radius_m: f64) -> u32 {
        let id = self.new_id();
        self.obstacles.push(Disc { id, place, radius_m });
        id
    }

    /// Opens a gas station and tells its number.
    pub fn put_station(&mut self, place: Point) -> u32 {
        let id = self.new_id();
        self.stations.push(Station { id, place });
        id
    }

    /// Marks a place that may do for a nest and tells its number.
    pub fn put_site(&mut self, place: Point, proper: bool) -> u32 {
        let id = self.new_id();
        self.sites.push(Site { id, place, proper });
        id
    }

    /// Lets someone in, who acts every so often, in seconds; tells the number.
    pub fn put_person(&mut self, place: Point, act_every_s: f64) -> u32 {
        let id = self.new_id();
        self.persons.push(Person {
            id,
            place,
            radius_m: 0.25,
            to: place,
            act_every_s,
            carries: false,
        });
        id
    }
}
