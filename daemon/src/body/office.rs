//! `office`: Allen's body in the simulated office of the `office` crate.
//!
//! ```text
//!  in:  ping (fires the ring), turn rad/s, forward m/s      out: sonar m, compass rad, odometry
//! ```

use ::office::{Config, Drive, Layout, Office, ROBOT_RADIUS_M};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Payload, Pose};
use ipc::wiring::{Declaration, Parameter, Port, Setting, Takes};
use serde_json::{Value, json};

use super::{BodyKind, Place, World, WorldEnd};

const PING: usize = 0;
const TURN: usize = 1;
const FORWARD: usize = 2;

const SONAR: usize = 0;
const COMPASS: usize = 1;
const ODOMETRY: usize = 2;

/// The kind `office`.
pub static KIND: BodyKind = BodyKind {
    declaration: &DECLARATION,
    motion: &[TURN, FORWARD],
    forward: Some(FORWARD),
    stale: Span::millis(200),
    build,
};

static DECLARATION: Declaration = Declaration {
    name: "office",
    about: "Allen's body, a round robot with twelve sonars, in a simulated office with people",
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
        Parameter {
            name: "people",
            takes: Takes::Number {
                low: 0.0,
                high: 40.0,
                default: Some(6.0),
            },
            unit: "1",
            about: "people who walk about",
        },
        Parameter {
            name: "attackers",
            takes: Takes::Number {
                low: 0.0,
                high: 20.0,
                default: Some(2.0),
            },
            unit: "1",
            about: "people who walk straight at the robot",
        },
        Parameter {
            name: "layout",
            takes: Takes::Word {
                words: &["office", "empty"],
                default: Some("office"),
            },
            unit: "",
            about: "rooms and corridor, or one empty room of 8 m by 6 m",
        },
    ],
};

/// Allen's body and the office around it.
pub struct OfficeWorld {
    /// The simulation.
    pub office: Office,
    last: Option<Time>,
    sonar: [f64; 12],
    range_max: f64,
}

fn build(settings: &[Setting], seed: u64, start: Option<Place>) -> Box<dyn World> {
    let [
        Setting::Number(people),
        Setting::Number(attackers),
        Setting::Text(layout),
    ] = settings
    else {
        panic!("settings of the office are checked");
    };
    let layout = if layout == "empty" {
        Layout::empty_room(8.0, 6.0)
    } else {
        Layout::office()
    };
    let config = Config {
        seed,
        people: *people as u32,
        attackers: *attackers as u32,
        layout,
        start,
        ..Config::default()
    };
    let range_max = config.sonar.range_max_m;
    Box::new(OfficeWorld {
        office: Office::new(&config),
        last: None,
        sonar: [range_max; 12],
        range_max,
    })
}

/// Longest step of the physics.
const STEP_MAX: Span = Span::millis(20);

impl World for OfficeWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let drive = Drive {
            forward: link.motion(FORWARD)[0],
            turn: link.motion(TURN)[0],
        };
        let mut left = self
            .last
            .map_or(Span::ZERO, |last| now.since(last))
            .0
            .min(Span::secs(1).0);
        self.last = Some(now);
        while left > 0 {
            let step = Span(left.min(STEP_MAX.0));
            self.office.step(step.seconds(), drive);
            left -= step.0;
        }
        if link.order(PING).is_some() {
            self.sonar = self.office.sonar();
            link.tell(SONAR, now, &Map { ranges: self.sonar }.pack());
        }
        let pose = self.office.odometry();
        link.tell(COMPASS, now, &pose.heading.pack());
        let odometry = Pose {
            x: pose.x,
            y: pose.y,
            heading: pose.heading,
        };
        link.tell(ODOMETRY, now, &odometry.pack());
    }

    fn view(&self) -> Value {
        let view = self.office.view();
        json!({
            "robot": view.robot,
            "people": view.people,
            "sonar": { "ranges_m": self.sonar, "max_m": self.range_max },
            "contacts": { "all": view.contacts, "caused": view.contacts_caused },
        })
    }

    fn floor(&self) -> Value {
        let plan = self.office.floor_plan();
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
