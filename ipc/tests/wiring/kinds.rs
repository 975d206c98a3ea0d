//! A small catalogue to check files against: a cart and the modules that drive it.
//!
//! Must never grow with the real modules: the golden messages of `bad/` name these kinds.

use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::{Catalog, Declaration, Fault, Parameter, Port, Takes};

const BLANK: Declaration = Declaration {
    name: "",
    about: "a module of the tests",
    diagram: "",
    inputs: &[],
    outputs: &[],
    parameters: &[],
};

const fn parameter(name: &'static str, takes: Takes) -> Parameter {
    Parameter {
        name,
        takes,
        unit: "",
        about: "a parameter of the tests",
    }
}

const fn port(name: &'static str, kind: Kind) -> Port {
    Port::new(name, kind, "a port of the tests")
}

static CART: Declaration = Declaration {
    name: "cart",
    inputs: &[
        port("forward", Kind::Number).unit("m/s"),
        port("turn", Kind::Number).unit("rad/s"),
    ],
    outputs: &[
        port("sonar", Kind::Map).unit("m"),
        port("compass", Kind::Number).unit("rad"),
        port("bumper", Kind::Pulse),
    ],
    parameters: &[
        parameter(
            "people",
            Takes::Number {
                low: 0.0,
                high: 20.0,
                default: Some(2.0),
            },
        ),
        parameter(
            "start",
            Takes::Numbers {
                low: f64::MIN,
                high: f64::MAX,
                most: 3,
                default: Some(&[0.0, 0.0]),
            },
        ),
        parameter(
            "course",
            Takes::File {
                bytes_max: 200,
                check: course_faults,
                instead_of: &["start"],
            },
        ),
    ],
    ..BLANK
};

static COLLIDE: Declaration = Declaration {
    name: "collide",
    inputs: &[port("map", Kind::Map).unit("m")],
    outputs: &[port("halt", Kind::Pulse)],
    ..BLANK
};

static FEEL: Declaration = Declaration {
    name: "feel",
    inputs: &[port("map", Kind::Map).unit("m")],
    outputs: &[port("force", Kind::Vector).unit("m")],
    ..BLANK
};

static RUNAWAY: Declaration = Declaration {
    name: "runaway",
    inputs: &[port("force", Kind::Vector).unit("m")],
    outputs: &[port("heading", Kind::Number).unit("rad")],
    parameters: &[parameter("gain", Takes::number(1.0))],
    ..BLANK
};

static TURN: Declaration = Declaration {
    name: "turn",
    inputs: &[
        port("heading", Kind::Number).unit("rad"),
        port("compass", Kind::Number).unit("rad"),
    ],
    outputs: &[
        port("rate", Kind::Number).unit("rad/s"),
        port("done", Kind::Pulse),
    ],
    ..BLANK
};

static FORWARD: Declaration = Declaration {
    name: "forward",
    inputs: &[port("go", Kind::Pulse), port("halt", Kind::Pulse)],
    outputs: &[port("speed", Kind::Number).unit("m/s")],
    parameters: &[parameter(
        "speed",
        Takes::Number {
            low: 0.0,
            high: 2.0,
            default: None,
        },
    )],
    ..BLANK
};

static WANDER: Declaration = Declaration {
    name: "wander",
    inputs: &[port("compass", Kind::Number).unit("rad")],
    outputs: &[port("heading", Kind::Number).unit("rad")],
    parameters: &[
        parameter(
            "every",
            Takes::Span {
                default: Some(Span::secs(10)),
            },
        ),
        parameter(
            "way",
            Takes::Word {
                words: &["random", "spiral"],
                default: Some("random"),
            },
        ),
        parameter("loud", Takes::Bit { default: Some(false) }),
    ],
    ..BLANK
};

/// A course is sound if each of its lines begins with `gate`.
fn course_faults(text: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let word = line.split_whitespace().next().unwrap_or("");
        if word != "gate" {
            faults.push(Fault {
                at: start..start + word.len(),
                message: format!("a {word:?} on the course"),
                help: "expected a gate".into(),
            });
        }
        start += line.len();
    }
    faults
}

static NOT: Declaration = Declaration {
    name: "not",
    inputs: &[port("value", Kind::Bit)],
    outputs: &[port("value", Kind::Bit)],
    ..BLANK
};

static AND: Declaration = Declaration {
    name: "and",
    inputs: &[port("a", Kind::Bit), port("b", Kind::Bit)],
    outputs: &[port("value", Kind::Bit)],
    ..BLANK
};

static CLOCK: Declaration = Declaration {
    name: "clock",
    outputs: &[port("tick", Kind::Pulse)],
    parameters: &[parameter("every", Takes::Span { default: None })],
    ..BLANK
};

/// Twenty outputs, to get to the bound on them with few lines.
static PANEL: Declaration = Declaration {
    name: "panel",
    outputs: &[port("lamp", Kind::Bit); 20],
    ..BLANK
};

/// The catalogue of the tests.
pub(crate) struct Kinds;

impl Catalog for Kinds {
    fn modules(&self) -> Vec<&'static Declaration> {
        vec![
            &COLLIDE, &FEEL, &RUNAWAY, &TURN, &FORWARD, &WANDER, &NOT, &AND, &CLOCK, &PANEL,
        ]
    }

    fn bodies(&self) -> Vec<&'static Declaration> {
        vec![&CART]
    }
}
