//! Seeded worlds: obstacles, objects, stations, sites and a person, all where the robot can get at them.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::geometry::Point;
use super::robot::{RADIUS_M, Robot};
use super::world::{FLOOR_X_M, FLOOR_Y_M, World};

/// Gas stations in a generated world.
pub const WORLD_STATIONS: usize = 2;
/// Tries to find room for one thing; a floor of this size never needs as many.
const TRIES_MAX: usize = 10_000;

/// What a generated world shall hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Fewest and most obstacles.
    pub obstacles: (usize, usize),
    /// Objects lying about.
    pub objects: usize,
    /// How many make a nest.
    pub wanted: usize,
    /// Whether there is a proper nest site.
    pub site: bool,
    /// How many persons walk about, carrying objects from here to there.
    pub persons: usize,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            obstacles: (4, 10),
            objects: 10,
            wanted: 6,
            site: true,
            persons: 1,
        }
    }
}

struct Placer {
    random: Pcg64,
    taken: Vec<(Point, f64)>,
}

impl Placer {
    /// A free place at least so far from walls and, edge to edge, from all that was placed.
    fn place(&mut self, walls_m: f64, radius_m: f64) -> Point {
        for _ in 0..TRIES_MAX {
            let x_m = self.random.random_range(walls_m..FLOOR_X_M - walls_m);
            let y_m = self.random.random_range(walls_m..FLOOR_Y_M - walls_m);
            let place = Point::new(x_m, y_m);
            if self
                .taken
                .iter()
                .all(|&(other, room_m)| place.distance_m(other) > room_m + radius_m)
            {
                return place;
            }
        }
        panic!("a generated world holds more than its floor has room for");
    }
}

/// A world from a seed.
#[must_use]
pub fn generate(seed: u64, layout: Layout) -> World {
    let mut placer = Placer {
        random: Pcg64::seed_from_u64(seed),
        taken: Vec::new(),
    };
    let start = placer.place(1.5, RADIUS_M);
    let heading_rad = placer.random.random_range(-3.0..3.0);
    let mut world = World::new(Robot::new(start, heading_rad), seed);
    world.wanted = layout.wanted;
    placer.taken.push((start, 0.6));
    let site = placer.place(2.0, 1.0);
    world.put_site(site, layout.site);
    placer.taken.push((site, 1.2));
    for _ in 0..WORLD_STATIONS {
        let place = placer.place(1.2, 0.6);
        world.put_station(place);
        placer.taken.push((place, 0.8));
    }
    for _ in 0..placer
        .random
        .random_range(layout.obstacles.0..=layout.obstacles.1)
    {
        let radius_m = placer.random.random_range(0.25..0.6);
        // Obstacles may touch each other, and then they are passed as one.
        let place = placer.place(1.3, radius_m * 0.5);
        world.put_obstacle(place, radius_m);
        placer.taken.push((place, radius_m * 0.5 + 0.25));
    }
    let obstacles = world.obstacles.clone();
    placer
        .taken
        .extend(obstacles.iter().map(|disc| (disc.place, disc.radius_m + 0.5)));
    for _ in 0..layout.objects {
        let place = placer.place(1.0, 0.1);
        world.put_object(place);
        placer.taken.push((place, 0.2));
    }
    for _ in 0..layout.persons {
        let place = placer.place(1.5, 0.8);
        world.put_person(place, 60.0);
    }
    world
}
