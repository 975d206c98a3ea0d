//! `office`: Allen's body in the simulated office of the `office` crate.
//!
//! The ports of the `rover` (see rover.rs), and further ones: `fan` m (the range camera's picture, on its own beat),
//! `battery` (share left; it charges where the robot started).

use std::sync::{Arc, Mutex, MutexGuard};

use ::office::{
    CameraModel, Config, Drive, KEPT, Layout, OdometryModel, Office, ROBOT_RADIUS_M, ROBOTS_MAX, SONARS,
    SonarModel,
};
use ipc::clock::{Span, Time};
use ipc::message::{Map, Payload, Pose};
use ipc::wiring::Setting;
use serde_json::{Value, json};

use super::rover::{self, FORWARD, PING, Progress, TURN};
use super::{BodyKind, Place, World, WorldEnd};

mod battery;
mod declaration;

pub use battery::Battery;
use declaration::DECLARATION;

const FAN: usize = 3;
const BATTERY: usize = 4;

/// The kind `office`.
pub static KIND: BodyKind = rover::kind(&DECLARATION, build);

/// An office with what its robots were told last; shared by the bodies in it.
struct Shared {
    office: Office,
    drives: [Drive; ROBOTS_MAX],
    progress: Progress,
}

/// One robot's body and the office around it.
pub struct OfficeWorld {
    shared: Arc<Mutex<Shared>>,
    robot: usize,
    sonar: [f64; SONARS],
    range_max: f64,
    picture: Span,
    picture_due: Time,
    battery: Battery,
}

/// The parameters of a body, by name.
struct Given<'s>(&'s [Setting]);

impl Given<'_> {
    fn get(&self, name: &str) -> &Setting {
        let index = DECLARATION.parameters.iter().position(|p| p.name == name);
        &self.0[index.unwrap_or_else(|| panic!("the office has no parameter {name:?}"))]
    }

    fn number(&self, name: &str) -> f64 {
        match self.get(name) {
            Setting::Number(number) => *number,
            other => panic!("{name:?} of the office is {other:?}"),
        }
    }

    fn layout(&self) -> Layout {
        if let Setting::File(Some(own)) = self.get("layout_file") {
            return match Layout::parse(&own.text) {
                Ok(layout) => layout,
                Err(error) => panic!("{}, which was checked: {error}", own.path.display()),
            };
        }
        let number = self.number("number") as u64;
        match self.get("layout") {
            Setting::Text(word) if word == "empty" => Layout::empty_room(8.0, 6.0),
            Setting::Text(word) if word == "kept" => {
                // Any number will do: the ten are counted round.
                Layout::kept((number.max(1) - 1) as usize % KEPT.len() + 1)
            }
            Setting::Text(word) if word == "generated" => Layout::generated(number),
            _ => Layout::office(),
        }
    }

    fn sonar(&self) -> SonarModel {
        let dead = match self.get("dead") {
            Setting::Numbers(numbers) => numbers.iter().map(|n| *n as usize).filter(|n| *n < SONARS),
            other => panic!("the dead sonars are {other:?}"),
        };
        SonarModel {
            noise_m: self.number("noise"),
            dropout: self.number("dropout"),
            ghosts: self.number("ghosts"),
            cross_talk: self.number("cross_talk"),
            specular_deg: self.number("specular"),
            polished_deg: self.number("polished"),
            cone_deg: self.number("cone"),
            dead: dead.fold(0, |bits, sonar| bits | 1 << sonar),
            ..SonarModel::default()
        }
    }
}

fn build(settings: &[Setting], seed: u64, start: Option<Place>) -> Box<dyn World> {
    Box::new(OfficeWorld::new(settings, seed, start, &[]))
}

impl OfficeWorld {
    /// The body of the first robot, from checked settings; further robots start at `others`.
    ///
    /// # Panics
    /// When the settings were not checked, or somebody would start inside something.
    pub fn new(settings: &[Setting], seed: u64, start: Option<Place>, others: &[Place]) -> OfficeWorld {
        let given = Given(settings);
        let config = Config {
            seed,
            people: given.number("people") as u32,
            attackers: given.number("attackers") as u32,
            talkers: given.number("talkers") as u32,
            cornerers: given.number("cornerers") as u32,
            layout: given.layout(),
            sonar: given.sonar(),
            camera: CameraModel::default(),
            odometry: OdometryModel {
                scale_sigma: given.number("drift"),
                slip_m: given.number("slip"),
                compass_sigma_rad: given.number("compass"),
                ..OdometryModel::default()
            },
            start,
            others: others.to_vec(),
            ..Config::default()
        };
        let Setting::Span(picture) = given.get("picture") else {
            panic!("the time between pictures is checked");
        };
        let shared = Shared {
            office: Office::new(&config),
            drives: [Drive::default(); ROBOTS_MAX],
            progress: Progress::default(),
        };
        let (shared, hours) = (Arc::new(Mutex::new(shared)), given.number("charge"));
        OfficeWorld::of(shared, 0, config.sonar.range_max_m, *picture, hours)
    }

    fn of(
        shared: Arc<Mutex<Shared>>,
        robot: usize,
        range_max: f64,
        picture: Span,
        hours: f64,
    ) -> OfficeWorld {
        let home = {
            let shared = shared.lock().expect("nobody panics holding an office");
            shared.office.true_pose_of(robot)
        };
        let battery = Battery::new(hours, (home.x, home.y));
        OfficeWorld {
            battery,
            shared,
            robot,
            sonar: [range_max; SONARS],
            range_max,
            picture,
            picture_due: Time::ZERO,
        }
    }

    /// The body of the `robot`-th robot of the same office, counted from 0.
    ///
    /// # Panics
    /// When there is no such robot.
    pub fn fellow(&self, robot: usize) -> OfficeWorld {
        assert!(robot < self.office().robots(), "there is no robot {robot}");
        let (range_max, picture, hours) = (self.range_max, self.picture, self.battery.hours);
        OfficeWorld::of(self.shared.clone(), robot, range_max, picture, hours)
    }

    /// The battery as it stands.
    pub fn battery(&self) -> Battery {
        self.battery
    }

    /// The office, for observers and tests.
    pub fn office(&self) -> OfficeGuard<'_> {
        OfficeGuard(self.shared.lock().expect("nobody panics holding an office"))
    }
}

/// The office of a body, held while it is looked at.
pub struct OfficeGuard<'w>(MutexGuard<'w, Shared>);

impl core::ops::Deref for OfficeGuard<'_> {
    type Target = Office;
    fn deref(&self) -> &Office {
        &self.0.office
    }
}

impl core::ops::DerefMut for OfficeGuard<'_> {
    fn deref_mut(&mut self) -> &mut Office {
        &mut self.0.office
    }
}

impl Shared {
    /// Lets time pass up to `now` with `robot` under `drive`; whichever robot comes first moves them all.
    fn advance(&mut self, now: Time, robot: usize, drive: Drive) {
        self.drives[robot] = drive;
        for step_s in self.progress.steps_to(now) {
            self.office.step_all(step_s, &self.drives);
        }
    }
}

impl World for OfficeWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let wanted = Drive {
            forward: link.motion(FORWARD)[0],
            turn: link.motion(TURN)[0],
        };
        let mut shared = self.shared.lock().expect("nobody panics holding an office");
        let at = shared.office.true_pose_of(self.robot);
        let drive = if self.battery.pass(now, (at.x, at.y)) {
            wanted
        } else {
            Drive::default()
        };
        shared.advance(now, self.robot, drive);
        let office = &mut shared.office;
        if self
            .battery
            .told
            .is_none_or(|told| now.since(told) >= Span::secs(1))
        {
            self.battery.told = Some(now);
            link.tell(BATTERY, now, &self.battery.left.pack());
        }
        if link.order(PING).is_some() {
            self.sonar = office.sonar_of(self.robot);
            rover::tell_sonar(link, now, self.sonar);
        }
        if now >= self.picture_due {
            self.picture_due = now + self.picture;
            let ranges = office.fan_of(self.robot);
            link.tell(FAN, now, &Map { ranges }.pack());
        }
        let pose = office.odometry_of(self.robot);
        let believed = Pose {
            x: pose.x,
            y: pose.y,
            heading: pose.heading,
        };
        rover::tell_pose(link, now, believed);
    }

    fn view(&self) -> Value {
        let view = self.office().view();
        json!({
            "robot": view.robot,
            "people": view.people,
            "sonar": { "ranges_m": self.sonar, "max_m": self.range_max },
            "contacts": { "all": view.contacts, "caused": view.contacts_caused },
        })
    }

    fn floor(&self) -> Value {
        let plan = self.office().floor_plan();
        let boxes: Vec<Value> = plan
            .blocks
            .iter()
            .map(|b| json!({"name": b.name, "kind": b.kind, "x": b.x, "y": b.y, "w": b.width, "h": b.depth, "heading": b.angle}))
            .collect();
        json!({
            "walls": [], "boxes": boxes, "bounds": [0.0, 0.0, plan.width, plan.height],
            "robot_radius_m": ROBOT_RADIUS_M,
        })
    }
}
