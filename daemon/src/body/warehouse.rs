//! `warehouse`: Allen's body in a world of another making, the `warehouse` crate.
//!
//! The ports of the `rover` (see rover.rs) and no others.

use ::warehouse::{ROBOT_RADIUS_M, Warehouse};
use ipc::clock::Time;
use ipc::message::Pose;
use ipc::wiring::{Declaration, Parameter, Setting};
use serde_json::{Value, json};

use super::rover::{self, FORWARD, PING, Progress, TURN};
use super::{BodyKind, Place, World, WorldEnd};

/// The kind `warehouse`.
pub static KIND: BodyKind = rover::kind(&DECLARATION, build);

static DECLARATION: Declaration = Declaration {
    name: "warehouse",
    about: "a round robot with twelve sonars in a simulated warehouse, a world of another making than the office",
    diagram: "ping -> sonar; turn, forward -> motion -> compass, odometry",
    inputs: rover::COMMANDS,
    outputs: rover::SENSES,
    parameters: &[
        Parameter::number("people", 6.0, "people who walk about the aisles")
            .between(0.0, 20.0)
            .unit("1"),
        Parameter::number(
            "number",
            1.0,
            "the seed of the floor and of all that happens on it",
        )
        .between(0.0, 1e15)
        .unit("1"),
        Parameter::bit("empty", false, "one empty hall of 8 m by 6 m instead"),
    ],
};

/// The robot's body and the warehouse around it.
pub struct WarehouseWorld {
    /// The simulation.
    pub warehouse: Warehouse,
    progress: Progress,
    sonar: [f64; 12],
}

fn build(settings: &[Setting], _seed: u64, _start: Option<Place>) -> Box<dyn World> {
    let [
        Setting::Number(people),
        Setting::Number(number),
        Setting::Bit(empty),
    ] = settings
    else {
        panic!("settings of the warehouse are checked");
    };
    Box::new(WarehouseWorld {
        warehouse: Warehouse::new(*number as u64, *people as usize, *empty),
        progress: Progress::default(),
        sonar: [10.0; 12],
    })
}

impl World for WarehouseWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let (forward, turn) = (link.motion(FORWARD)[0], link.motion(TURN)[0]);
        for step_s in self.progress.steps_to(now) {
            self.warehouse.step(step_s, forward, turn);
        }
        if link.order(PING).is_some() {
            self.sonar = self.warehouse.sonar();
            rover::tell_sonar(link, now, self.sonar);
        }
        let (x, y, heading) = self.warehouse.believed();
        rover::tell_pose(link, now, Pose { x, y, heading });
    }

    fn view(&self) -> Value {
        let report = self.warehouse.report();
        let (x, y, heading) = report.pose;
        let person = |(x, y, heading)| json!({"kind": "walker", "x": x, "y": y, "heading": heading});
        let people: Vec<Value> = self.warehouse.people().map(person).collect();
        json!({
            "robot": { "x": x, "y": y, "heading": heading },
            "people": people,
            "sonar": { "ranges_m": self.sonar, "max_m": 10.0 },
            "contacts": { "all": report.contacts, "caused": report.caused },
        })
    }

    fn floor(&self) -> Value {
        let floor = self.warehouse.floor();
        let (width, depth) = floor.size();
        let cell = |(x, y)| json!({"name": "rack", "kind": "cabinet", "x": x, "y": y, "w": 0.1, "h": 0.1, "heading": 0.0});
        let boxes: Vec<Value> = floor.full_cells().map(cell).collect();
        json!({
            "walls": [], "boxes": boxes, "bounds": [0.0, 0.0, width, depth],
            "robot_radius_m": ROBOT_RADIUS_M,
        })
    }
}
