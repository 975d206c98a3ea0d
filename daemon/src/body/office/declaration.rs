//! What the office body looks like on wires and in a creature file.
//!
//! Must never hold a value that the world does not take from here.

use ::office::{LAYOUT_BYTES_MAX, Layout};
use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Fault, Parameter, Port, Takes};

use crate::body::rover;

pub(super) static DECLARATION: Declaration = Declaration {
    name: "office",
    about: "Allen's body, a round robot with twelve sonars and a range camera, in a simulated office with people",
    diagram: "ping -> sonar; turn, forward -> motion -> compass, odometry; every picture: fan",
    inputs: rover::COMMANDS,
    outputs: &[
        rover::SENSES[0],
        rover::SENSES[1],
        rover::SENSES[2],
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
        Parameter::number("people", 6.0, "people who walk about, as far as there is room")
            .between(0.0, 40.0)
            .unit("1"),
        Parameter::number("attackers", 2.0, "people who walk straight at the robot")
            .between(0.0, 20.0)
            .unit("1"),
        Parameter::word(
            "layout",
            &["office", "empty", "kept", "generated"],
            "office",
            "the standard office, one empty room of 8 m by 6 m, one of the ten kept, one drawn from a seed",
        ),
        Parameter::number(
            "number",
            1.0,
            "which of the kept offices, or the seed of a generated one",
        )
        .between(0.0, 1e15)
        .unit("1"),
        Parameter::new(
            "layout_file",
            Takes::File {
                bytes_max: LAYOUT_BYTES_MAX,
                check: layout_faults,
                instead_of: &["layout", "number"],
            },
            "an office of your own, read from this file; `subsumectl new layout NAME` writes one to begin from",
        ),
        Parameter::number("talkers", 0.0, "people who stand in groups of three and talk")
            .between(0.0, 20.0)
            .unit("1"),
        Parameter::number("cornerers", 0.0, "people who corner the robot")
            .between(0.0, 10.0)
            .unit("1"),
        Parameter::number("noise", 0.02, "error of a sonar range, one sigma")
            .between(0.0, 1.0)
            .unit("m"),
        Parameter::number("dropout", 0.01, "share of sonar ranges that are lost")
            .between(0.0, 1.0)
            .unit("1"),
        Parameter::number(
            "ghosts",
            0.3,
            "share of mirrored echoes that come home after several bounces",
        )
        .between(0.0, 1.0)
        .unit("1"),
        Parameter::number("cross_talk", 0.01, "share of ranges that are a neighbour's")
            .between(0.0, 1.0)
            .unit("1"),
        Parameter::number(
            "specular",
            30.0,
            "plain surfaces met at less than this are mirrors to sound",
        )
        .between(0.0, 90.0)
        .unit("deg"),
        Parameter::number("polished", 55.0, "the same for polished surfaces and glass")
            .between(0.0, 90.0)
            .unit("deg"),
        Parameter::number("cone", 30.0, "full width of a sonar's cone")
            .between(0.0, 60.0)
            .unit("deg"),
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
        Parameter::number("drift", 0.01, "error of the wheels' size, one sigma")
            .between(0.0, 1.0)
            .unit("1"),
        Parameter::number("slip", 0.01, "error of the odometry after one metre, one sigma")
            .between(0.0, 1.0)
            .unit("m"),
        Parameter::number("compass", 0.02, "error of the compass, one sigma")
            .between(0.0, 1.0)
            .unit("rad"),
        Parameter::span(
            "picture",
            Span::millis(400),
            "time between two pictures of the range camera",
        ),
        Parameter::number("charge", 0.0, "how long a full charge lasts; 0 for ever")
            .between(0.0, 1000.0)
            .unit("h"),
    ],
};

/// All that is wrong with the text of a layout.
fn layout_faults(text: &str) -> Vec<Fault> {
    let Err(errors) = Layout::read(text) else {
        return Vec::new();
    };
    let faults = errors.into_iter().map(|error| Fault {
        at: error.at,
        message: error.message,
        help: error.help,
    });
    faults.collect()
}
