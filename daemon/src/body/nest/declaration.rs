//! What the nest builder's body looks like on wires and in a creature file.
//!
//! Must never hold a value that the world does not take from here.

use adroit::nest::Scene;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter, Port};

/// The inputs, all of which move something.
pub(super) const WHEEL: usize = 0;
pub(super) const STEER: usize = 1;
pub(super) const REACH: usize = 2;
pub(super) const HAND: usize = 3;

/// Far more than the number of any thing.
const NUMBER_MAX: f64 = 1e6;

/// A message of up to four things, three numbers each.
const fn things(name: &'static str, about: &'static str) -> Port {
    Port::new(name, Kind::Map, about).between(-100.0, NUMBER_MAX)
}

pub(super) static DECLARATION: Declaration = Declaration {
    name: "nest",
    about: "a robot with eyes, arm, hand and tank among objects, obstacles, gas stations and persons (Friedman 1969)",
    diagram: "wheel, steer, reach, hand -> motion -> pose, limbs, fuel; eyes -> objects, stations, persons, site, obstacles",
    inputs: &[
        Port::new("wheel", Kind::Number, "speed of the driven wheel")
            .unit("m/s")
            .between(-2.0, 2.0),
        Port::new("steer", Kind::Number, "how the steering wheel shall stand")
            .unit("rad")
            .between(-3.2, 3.2),
        Port::new(
            "reach",
            Kind::Polar,
            "how long the arm shall be, and its direction",
        )
        .unit("m")
        .between(-3.2, 3.2),
        Port::new(
            "hand",
            Kind::Number,
            "number of the object to hold, zero for none",
        )
        .between(0.0, NUMBER_MAX),
    ],
    outputs: &[
        Port::new("pose", Kind::Pose, "where the robot is"),
        Port::new("steering", Kind::Number, "steering wheel against straight ahead").unit("rad"),
        Port::new("rolled", Kind::Number, "way of the driven wheel since the start").unit("m"),
        Port::new("arm", Kind::Polar, "length and direction of the arm").unit("m"),
        Port::new(
            "held",
            Kind::Number,
            "number of the object in the hand, zero for none",
        ),
        Port::new("fuel", Kind::Number, "fuel in the tank")
            .unit("1")
            .between(0.0, 1.0),
        Port::new("filling", Kind::Bit, "fuel flows"),
        Port::new("bumped", Kind::Bit, "the body is against something"),
        Port::new("cold", Kind::Bit, "temperature is below the threshold"),
        Port::new("ordered", Kind::Bit, "an order to build is heard"),
        Port::new("whistle", Kind::Bit, "someone whistles"),
        Port::new("red_light", Kind::Bit, "a red light is on"),
        things("objects", "objects in view: number, x, y of the four nearest"),
        things("stations", "gas stations in view: number, x, y"),
        things("persons", "persons in view: number, x, y"),
        things(
            "site",
            "a nest site in view: number, x, y, how many objects lie there",
        ),
        things(
            "obstacles",
            "obstacles in view: radius in millimetres, x, y of the nearest",
        ),
        things("obstacles_2", "the next four obstacles"),
        things("obstacles_3", "four more"),
    ],
    parameters: &[
        Parameter::word(
            "scene",
            &Scene::NAMES,
            "seeded",
            "a world from a seed, or one of the published demonstrations",
        ),
        Parameter::number("number", 1.0, "the seed of the world")
            .between(0.0, 1e15)
            .unit("1"),
        Parameter::number("objects", 10.0, "objects lying about")
            .between(0.0, 30.0)
            .unit("1"),
        Parameter::number("wanted", 6.0, "how many objects make a nest, for those who watch")
            .between(1.0, 100.0)
            .unit("1"),
        Parameter::number(
            "persons",
            1.0,
            "persons who take things and put them down elsewhere",
        )
        .between(0.0, 10.0)
        .unit("1"),
        Parameter::bit("site", true, "whether there is a proper nest site"),
        Parameter::bit(
            "cold",
            true,
            "whether it is cold, which is what excites nest building",
        ),
    ],
};
