//! The published demonstrations, each as a world to watch: what stands where, and what happens in it.
//!
//! Must never: help the robot. What happens is what someone in the room could do.

use super::generator::{Layout, generate};
use super::geometry::Point;
use super::robot::Robot;
use super::world::World;

/// A demonstration (source: *The nest building demonstration*, and what the control program is said to do).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// A world from a seed, with a person in it.
    Seeded,
    /// The site is found in a single sweep, and the nest built to the wanted number.
    SingleSweep,
    /// There is no site: the search fails up to the top, and another activity is taken.
    NoSite,
    /// An object is put down in front of the robot on its way to another one.
    PutInFront,
    /// The first object lies within reach: nothing is done to get there.
    WithinReach,
    /// Someone else brings the objects.
    Brought,
    /// The fuel does not last for the nest.
    Refuelling,
    /// One obstacle on the way.
    OneObstacle,
    /// Two that have to be passed as one.
    TwoObstacles,
    /// A wall of them.
    MoreObstacles,
    /// Cold and thirst pull equally: the robot does neither, but waves its arm, until fuel tips the scales.
    Tie,
}

impl Scene {
    /// All scenes.
    pub const ALL: [Self; 11] = [
        Self::Seeded,
        Self::SingleSweep,
        Self::NoSite,
        Self::PutInFront,
        Self::WithinReach,
        Self::Brought,
        Self::Refuelling,
        Self::OneObstacle,
        Self::TwoObstacles,
        Self::MoreObstacles,
        Self::Tie,
    ];

    /// Their names, in the same order.
    pub const NAMES: [&'static str; 11] = [
        "seeded",
        "single-sweep",
        "no-site",
        "put-in-front",
        "within-reach",
        "brought",
        "refuelling",
        "one-obstacle",
        "two-obstacles",
        "more-obstacles",
        "tie",
    ];

    /// The scene of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let place = Self::NAMES.iter().position(|known| *known == name)?;
        Some(Self::ALL[place])
    }

    /// The world it plays in; `layout` and `seed` count for those drawn from a seed.
    #[must_use]
    pub fn world(self, seed: u64, layout: Layout) -> World {
        let alone = Layout { persons: 0, ..layout };
        let mut world = match self {
            Self::Seeded => return generate(seed, layout),
            Self::SingleSweep => return generate(3, alone),
            Self::NoSite => return generate(3, Layout { site: false, ..alone }),
            Self::PutInFront | Self::WithinReach | Self::Brought | Self::Refuelling | Self::Tie => {
                let mut world = World::new(Robot::new(Point::new(8.0, 6.0), 0.0), seed);
                world.put_site(Point::new(7.3, 6.0), true);
                world
            }
            Self::OneObstacle | Self::TwoObstacles | Self::MoreObstacles => {
                let mut world = World::new(Robot::new(Point::new(6.0, 6.0), 0.0), seed);
                world.put_site(Point::new(5.3, 6.0), true);
                world.planning = false;
                world
            }
        };
        world.wanted = layout.wanted;
        world.scene = self;
        self.furnish(&mut world);
        world
    }

    fn furnish(self, world: &mut World) {
        let spread = |world: &mut World, x_m: f64| {
            for number in 0..world.wanted {
                let (column, row) = ((number / 3) as f64, (number % 3) as f64);
                world.put_object(Point::new(x_m + 0.5 * column, 5.4 + 0.6 * row));
            }
        };
        match self {
            Self::PutInFront => spread(world, 12.0),
            Self::WithinReach => {
                world.put_object(Point::new(8.5, 6.0));
                spread(world, 11.0);
            }
            Self::Refuelling => {
                world.put_station(Point::new(10.0, 8.5));
                spread(world, 11.0);
                world.robot.fuel = 0.75;
            }
            Self::Tie => {
                // Behind the robot, where its eyes do not see it.
                world.put_station(Point::new(2.0, 6.0));
                spread(world, 11.0);
                // Four times what is missing, less a half, is exactly the one that the cold gives nest building.
                world.robot.fuel = 0.625;
            }
            Self::OneObstacle | Self::TwoObstacles | Self::MoreObstacles => {
                world.put_object(Point::new(9.8, 6.0));
                spread(world, 12.0);
                let count = match self {
                    Self::OneObstacle => 1,
                    Self::TwoObstacles => 2,
                    _ => 4,
                };
                for y_m in [6.45, 5.55, 7.3, 4.7].into_iter().take(count) {
                    world.put_obstacle(Point::new(8.5, y_m), 0.4);
                }
            }
            Self::Seeded | Self::SingleSweep | Self::NoSite | Self::Brought => {}
        }
    }

    /// What happens in a beat of a scene.
    pub(super) fn happen(self, world: &mut World) {
        match self {
            Self::PutInFront if world.happened == 0 && world.robot.place.x_m > 9.0 => {
                let front = world.robot.place.towards(world.robot.heading_rad, 0.6);
                world.put_object(front);
                world.happened = 1;
            }
            // From ten seconds on, one every three seconds, into the nest.
            Self::Brought
                if world.happened < world.wanted && world.now_s > 10.0 + 3.0 * world.happened as f64 =>
            {
                let turn_rad = world.happened as f64 * 2.4;
                world.put_object(Point::new(7.3, 6.0).towards(turn_rad, 0.4));
                world.happened += 1;
            }
            _ => {}
        }
    }
}
