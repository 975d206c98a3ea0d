//! `warehouse`: Allen's body in a world of another making, the `warehouse` crate.
//!
//! ```text
//!  in:  ping (fires the ring), turn rad/s, forward m/s      out: sonar m, compass rad, odometry
//! ```
//! The ports that levels 0 and 1 need, under the same names: their wiring files are used as they are.

use ::warehouse::{ROBOT_RADIUS_M, Warehouse};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Payload, Pose};
use ipc::wiring::{Declaration, Parameter, Port, Setting};
use serde_json::{Value, json};

use super::{BodyKind, Place, World, WorldEnd};

const PING: usize = 0;
const TURN: usize = 1;
const FORWARD: usize = 2;

const SONAR: usize = 0;
const COMPASS: usize = 1;
const ODOMETRY: usize = 2;

/// The kind `warehouse`.
pub static KIND: BodyKind = BodyKind {
    declaration: &DECLARATION,
    motion: &[TURN, FORWARD],
    forward: Some(FORWARD),
    stale: Span::millis(200),
    build,
};

static DECLARATION: Declaration = Declaration {
    name: "warehouse",
    about: "a round robot with twelve sonars in a simulated warehouse, a world of another making than the office",
    diagram: "ping -> sonar; turn, forward -> motion -> compass, odometry",
    inputs: &[
        Port::new("ping", Kind::Pulse, "fires the ring of sonars"),
        Port::new("turn", Kind::Number, "turning rate")
            .unit("rad/s")
            .between(-10.0, 10.0),
        Port::new("forward", Kind::Number, "forward speed")
            .unit("m/s")
            .between(-2.0, 2.0),
    ],
    outputs: &[
        Port::new("sonar", Kind::Map, "what the ring heard, straight ahead first")
            .unit("m")
            .between(0.0, 100.0),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
        Port::new("odometry", Kind::Pose, "where the wheels think they are"),
    ],
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
    last: Option<Time>,
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
        last: None,
        sonar: [10.0; 12],
    })
}

/// Longest step of the physics, and longest gap made up for.
const STEP_MAX: Span = Span::millis(20);
const GAP_MAX: Span = Span::secs(1);

impl World for WarehouseWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let (forward, turn) = (link.motion(FORWARD)[0], link.motion(TURN)[0]);
        let gap = self.last.replace(now).map_or(Span::ZERO, |last| now.since(last));
        let mut left = gap.0.min(GAP_MAX.0);
        while left > 0 {
            let step = Span(left.min(STEP_MAX.0));
            self.warehouse.step(step.seconds(), forward, turn);
            left -= step.0;
        }
        if link.order(PING).is_some() {
            self.sonar = self.warehouse.sonar();
            link.tell(SONAR, now, &Map { ranges: self.sonar }.pack());
        }
        let (x, y, heading) = self.warehouse.believed();
        link.tell(COMPASS, now, &heading.pack());
        link.tell(ODOMETRY, now, &Pose { x, y, heading }.pack());
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
