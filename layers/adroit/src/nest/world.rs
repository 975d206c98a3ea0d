//! The world: what stands and lies on the floor, and what one beat does to it.

use rand_pcg::Pcg64;
use serde::Serialize;

use super::eyes::Seen;
use super::geometry::Point;
use super::motor::Working;
use super::person::Person;
use super::robot::{FILLING_PER_S, IDLE_PER_S, PUMP_M, RADIUS_M, Robot};
use super::scenes::Scene;
use crate::hierarchy::McuId;
use crate::planning::Planner;

/// One beat of the virtual clock, seconds.
pub const BEAT_S: f64 = 0.05;
/// Width of the floor, metres.
pub const FLOOR_X_M: f64 = 16.0;
/// Depth of the floor, metres.
pub const FLOOR_Y_M: f64 = 12.0;
/// Objects count as the nest's within this distance of the middle of the site, metres.
pub const NEST_RADIUS_M: f64 = 0.8;
/// How long an order is heard, seconds.
const ORDER_S: f64 = 5.0;
/// After a round without result the robot may search again after this long, seconds.
const REST_S: f64 = 90.0;

/// A round obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disc {
    /// Number of the thing.
    pub id: u32,
    /// Its middle.
    pub place: Point,
    /// Its radius, metres.
    pub radius_m: f64,
}

/// Something to build with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Object {
    /// Number of the thing.
    pub id: u32,
    /// Where it lies.
    pub place: Point,
}

/// A gas station.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Station {
    /// Number of the thing.
    pub id: u32,
    /// Where it is.
    pub place: Point,
}

/// A place that may do for a nest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Site {
    /// Number of the thing.
    pub id: u32,
    /// Its middle.
    pub place: Point,
    /// Whether it meets the criteria of a nest site.
    pub proper: bool,
}

/// The world with the robot in it.
#[derive(Clone, Debug)]
pub struct World {
    /// Time since the start, seconds.
    pub now_s: f64,
    /// The robot.
    pub robot: Robot,
    /// What lies about.
    pub objects: Vec<Object>,
    /// What stands in the way.
    pub obstacles: Vec<Disc>,
    /// Where fuel is.
    pub stations: Vec<Station>,
    /// Where a nest could be.
    pub sites: Vec<Site>,
    /// Who walks about.
    pub persons: Vec<Person>,
    /// How many objects make a nest.
    pub wanted: usize,
    /// Temperature is below the threshold.
    pub cold: bool,
    /// Someone whistles.
    pub whistle: bool,
    /// A red light is on.
    pub red_light: bool,
    /// Whether the robot plans ahead.
    pub planning: bool,
    pub(crate) ordered_until_s: f64,
    pub(crate) seen: Seen,
    pub(crate) planner: Planner,
    pub(crate) random: Pcg64,
    pub(crate) next_id: u32,
    pub(crate) interrupt: bool,
    pub(crate) way_m: f64,
    pub(crate) burnt: f64,
    pub(crate) bumps: u32,
    pub(crate) stranded: bool,
    /// The demonstration it is, and how much of what happens in it has happened.
    pub(super) scene: Scene,
    pub(super) happened: usize,
    /// Way of the driven wheel, metres.
    pub(super) rolled_m: f64,
    /// How long the hand has been about to change, seconds.
    pub(super) hand_s: f64,
    beats: u64,
}

impl World {
    /// An empty floor with a robot on it.
    #[must_use]
    pub fn new(robot: Robot, seed: u64) -> Self {
        Self {
            now_s: 0.0,
            robot,
            objects: Vec::new(),
            obstacles: Vec::new(),
            stations: Vec::new(),
            sites: Vec::new(),
            persons: Vec::new(),
            wanted: 6,
            cold: true,
            whistle: false,
            red_light: false,
            planning: true,
            ordered_until_s: f64::NEG_INFINITY,
            seen: Seen::default(),
            planner: Planner::default(),
            random: Pcg64::new(u128::from(seed), 0x000a_d201),
            next_id: 1,
            interrupt: true,
            way_m: 0.0,
            burnt: 0.0,
            bumps: 0,
            stranded: false,
            scene: Scene::Seeded,
            happened: 0,
            rolled_m: 0.0,
            hand_s: 0.0,
            beats: 0,
        }
    }

    /// Objects that lie at a site.
    #[must_use]
    pub fn lying_at(&self, site: Point) -> usize {
        let held = self.robot.held;
        self.objects
            .iter()
            .filter(|object| Some(object.id) != held && object.place.distance_m(site) <= NEST_RADIUS_M)
            .count()
    }

    /// The site the robot builds at.
    #[must_use]
    pub fn known_site(&self) -> Option<Site> {
        let id = self.robot.site?;
        self.sites.iter().copied().find(|site| site.id == id)
    }

    /// Whether the wanted number lies at the robot's site.
    #[must_use]
    pub fn nest_complete(&self) -> bool {
        self.known_site()
            .is_some_and(|site| self.lying_at(site.place) >= self.wanted)
    }

    /// Whether an order is heard.
    #[must_use]
    pub fn ordered(&self) -> bool {
        self.now_s < self.ordered_until_s
    }

    /// Lets an order be heard from now on, for a short time.
    pub fn order(&mut self) {
        self.ordered_until_s = self.now_s + ORDER_S;
        self.interrupt = true;
    }

    /// One beat: the working MCUs go on, then everything else moves, then the eyes look. Tells through
    /// `ended` which MCUs ended, and whether they did what they were called for.
    pub(crate) fn beat(&mut self, working: &mut [Option<Working>], mut ended: impl FnMut(McuId, bool)) {
        self.begin_beat();
        for slot in working {
            if let Some(unit) = slot
                && let Some(succeeded) = self.work(unit)
            {
                ended(unit.mcu, succeeded);
                *slot = None;
            }
        }
        self.end_beat();
    }

    pub(super) fn begin_beat(&mut self) {
        self.beats += 1;
        self.now_s = self.beats as f64 * BEAT_S;
    }

    /// Everything but the robot's own movements.
    pub(super) fn end_beat(&mut self) {
        if let Some(held) = self.robot.held {
            let hand = self.robot.hand();
            if let Some(object) = self.objects.iter_mut().find(|object| object.id == held) {
                object.place = hand;
            }
        }
        self.scene.happen(self);
        self.burn(IDLE_PER_S * BEAT_S);
        self.fill();
        self.move_persons();
        self.look();
        self.remember();
    }

    pub(crate) fn burn(&mut self, part: f64) {
        let part = part.min(self.robot.fuel);
        self.robot.fuel -= part;
        self.burnt += part;
        if self.robot.fuel <= 0.0 {
            self.stranded = true;
        }
    }

    fn fill(&mut self) {
        let hand = self.robot.hand();
        let at_pump = self
            .stations
            .iter()
            .any(|station| station.place.distance_m(hand) <= PUMP_M);
        self.robot.filling = at_pump && self.robot.fuel < 1.0;
        if self.robot.filling {
            self.robot.fuel = (self.robot.fuel + FILLING_PER_S * BEAT_S).min(1.0);
        }
    }

    /// What the robot remembers of its rounds.
    pub(super) fn remember_round(&mut self) {
        let (place, now_s) = (self.robot.place, self.now_s);
        let robot = &mut self.robot;
        for (sweep, rest_s) in [
            (&mut robot.sweeps.site, REST_S),
            (&mut robot.sweeps.object, REST_S),
            (&mut robot.sweeps.station, 0.0),
        ] {
            sweep.renew_after(rest_s, now_s);
            sweep.pass(place, now_s);
        }
        robot.sweeps.object.found |= robot.held.is_some();
    }

    fn remember(&mut self) {
        self.remember_round();
        if self.robot.site.is_none()
            && let Some(found) = self.seen.site
        {
            self.robot.site = Some(found);
            self.interrupt = true;
        }
        if let Some(site) = self.known_site()
            && self.seen.nest
        {
            self.robot.counted = self.lying_at(site.place);
        }
    }

    /// Moves the middle of the robot, if nothing is in the way there.
    pub(crate) fn move_robot(&mut self, to: Point) -> bool {
        let from = self.robot.place;
        // Someone may have walked into the robot; away from them it may always go.
        let deeper = self.persons.iter().any(|person| {
            person.place.distance_m(to) < (RADIUS_M + person.radius_m).min(person.place.distance_m(from))
        });
        let blocked = self
            .obstacles
            .iter()
            .any(|disc| disc.place.distance_m(to) < RADIUS_M + disc.radius_m);
        let inside = |at: f64, size: f64| at > RADIUS_M && at < size - RADIUS_M;
        if deeper || blocked || !inside(to.x_m, FLOOR_X_M) || !inside(to.y_m, FLOOR_Y_M) {
            return false;
        }
        self.way_m += from.distance_m(to);
        self.robot.place = to;
        true
    }
}
