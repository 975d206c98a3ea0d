//! What the office body looks like on wires and in a creature file.
//!
//! Must never hold a value that the world does not take from here.

use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter, Port, Takes};

pub(super) static DECLARATION: Declaration = Declaration {
    name: "office",
    about: "Allen's body, a round robot with twelve sonars and a range camera, in a simulated office with people",
    diagram: "ping -> sonar; turn, forward -> motion -> compass, odometry; every picture: fan",
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
        Port::new(
            "fan",
            Kind::Map,
            "free distances in twelve strips of sixty degrees ahead, leftmost first",
        )
        .unit("m")
        .between(0.0, 100.0),
        Port::new(
            "battery",
            Kind::Number,
            "share of the charge that is left, once a second",
        )
        .unit("1")
        .between(0.0, 1.0),
    ],
    parameters: &[
        count("people", 6.0, 40.0, "people who walk about"),
        count("attackers", 2.0, 20.0, "people who walk straight at the robot"),
        Parameter {
            name: "layout",
            takes: Takes::Word {
                words: &["office", "empty", "kept", "generated"],
                default: Some("office"),
            },
            unit: "",
            about: "the standard office, one empty room of 8 m by 6 m, one of the ten kept, one drawn from a seed",
        },
        count(
            "number",
            1.0,
            1e15,
            "which of the kept offices, or the seed of a generated one",
        ),
        count(
            "talkers",
            0.0,
            20.0,
            "people who stand in groups of three and talk",
        ),
        count("cornerers", 0.0, 10.0, "people who corner the robot"),
        number("noise", 0.02, 1.0, "m", "error of a sonar range, one sigma"),
        number("dropout", 0.01, 1.0, "1", "share of sonar ranges that are lost"),
        number(
            "ghosts",
            0.3,
            1.0,
            "1",
            "share of mirrored echoes that come home after several bounces",
        ),
        number(
            "cross_talk",
            0.01,
            1.0,
            "1",
            "share of ranges that are a neighbour's",
        ),
        number(
            "specular",
            30.0,
            90.0,
            "deg",
            "plain surfaces met at less than this are mirrors to sound",
        ),
        number(
            "polished",
            55.0,
            90.0,
            "deg",
            "the same for polished surfaces and glass",
        ),
        number("cone", 30.0, 60.0, "deg", "full width of a sonar's cone"),
        Parameter {
            name: "dead",
            takes: Takes::Numbers {
                low: 0.0,
                high: 11.0,
                most: 12,
                default: Some(&[]),
            },
            unit: "",
            about: "sonars that hear nothing, numbered from 0, straight ahead, counter-clockwise",
        },
        number("drift", 0.01, 1.0, "1", "error of the wheels' size, one sigma"),
        number(
            "slip",
            0.01,
            1.0,
            "m",
            "error of the odometry after one metre, one sigma",
        ),
        number("compass", 0.02, 1.0, "rad", "error of the compass, one sigma"),
        Parameter {
            name: "picture",
            takes: Takes::Span {
                default: Some(Span::millis(400)),
            },
            unit: "",
            about: "time between two pictures of the range camera",
        },
        number(
            "charge",
            0.0,
            1000.0,
            "h",
            "how long a full charge lasts; 0 for ever",
        ),
    ],
};

const fn count(name: &'static str, default: f64, high: f64, about: &'static str) -> Parameter {
    number(name, default, high, "1", about)
}

const fn number(
    name: &'static str,
    default: f64,
    high: f64,
    unit: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter {
        name,
        takes: Takes::Number {
            low: 0.0,
            high,
            default: Some(default),
        },
        unit,
        about,
    }
}
