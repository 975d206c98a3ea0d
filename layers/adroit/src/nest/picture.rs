//! The world and the lit tree as data, for a live page.

use serde::Serialize;

use super::run::Run;
use super::world::{Disc, FLOOR_X_M, FLOOR_Y_M, NEST_RADIUS_M, Object, Site, Station, World};
use super::{EYES_RANGE_M, EYES_SIDE_RAD, Person, Point, Robot};
use crate::hierarchy::{LevelIndex, Yielded};

/// One RM of the tree as a lamp on the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lamp {
    /// Name of the RM.
    pub name: String,
    /// What its level belongs to: `top`, an RM or a subroutine.
    pub level: String,
    /// Its inputs are open.
    pub listens: bool,
    /// It is in control.
    pub active: bool,
    /// Its inputs less its threshold.
    pub excitation: f64,
    /// Why it yielded, in a word.
    pub yielded: Option<&'static str>,
}

/// A place at one moment: everything but the hierarchy.
#[derive(Clone, Debug, Serialize)]
pub struct View<'a> {
    /// Time since the start, seconds.
    pub time_s: f64,
    /// Size of the floor, metres.
    pub floor_m: (f64, f64),
    /// The robot.
    pub robot: &'a Robot,
    /// Where its hand is.
    pub hand: Point,
    /// Range of its eyes, metres, and how far they see to either side, radians.
    pub eyes: (f64, f64),
    /// What lies about.
    pub objects: &'a [Object],
    /// What stands in the way.
    pub obstacles: &'a [Disc],
    /// Where fuel is.
    pub stations: &'a [Station],
    /// Where a nest could be.
    pub sites: &'a [Site],
    /// Radius of a nest, metres.
    pub nest_m: f64,
    /// Who walks about.
    pub persons: &'a [Person],
    /// How many objects make a nest.
    pub wanted: usize,
    /// How many lie at the site that the robot saw.
    pub built: usize,
}

/// The view of a world, ready to be written as JSON.
#[must_use]
pub fn view(world: &World) -> View<'_> {
    View {
        time_s: world.now_s,
        floor_m: (FLOOR_X_M, FLOOR_Y_M),
        robot: &world.robot,
        hand: world.robot.hand(),
        eyes: (EYES_RANGE_M, EYES_SIDE_RAD),
        objects: &world.objects,
        obstacles: &world.obstacles,
        stations: &world.stations,
        sites: &world.sites,
        nest_m: NEST_RADIUS_M,
        persons: &world.persons,
        wanted: world.wanted,
        built: world.known_site().map_or(0, |site| world.lying_at(site.place)),
    }
}

/// Everything a page needs to draw one moment.
#[derive(Clone, Debug, Serialize)]
pub struct Picture<'a> {
    /// The world.
    #[serde(flatten)]
    pub view: View<'a>,
    /// The way planned ahead.
    pub plan: &'a [Point],
    /// MCUs at work.
    pub working: Vec<&'a str>,
    /// The tree, level by level.
    pub tree: Vec<Lamp>,
}

/// A picture of a run, ready to be written as JSON.
#[must_use]
pub fn picture(run: &Run) -> Picture<'_> {
    let hierarchy = run.control.hierarchy();
    let mut tree = Vec::new();
    for level in 0..hierarchy.levels().len() {
        let level = LevelIndex(u16::try_from(level).expect("bounded by MECHANISMS_MAX"));
        for member in hierarchy.members(level) {
            tree.push(Lamp {
                name: hierarchy.name(member).to_owned(),
                level: hierarchy.caption(level).to_owned(),
                listens: hierarchy.listens(member),
                active: hierarchy.active(member),
                excitation: hierarchy.excitation(member),
                yielded: hierarchy.yielded(member).map(|why| match why {
                    Yielded::NoGoal => "no goal",
                    Yielded::GoalHolds => "goal holds",
                    Yielded::Below => "failure below",
                    Yielded::Motor => "motor failure",
                    Yielded::Conflict => "conflict",
                }),
            });
        }
    }
    let world = &run.world;
    let vocabulary = run.control.vocabulary();
    Picture {
        view: view(world),
        plan: world.planner.way(),
        working: hierarchy
            .outputs()
            .iter()
            .map(|output| vocabulary.mcu_name(output.mcu))
            .collect(),
        tree,
    }
}
