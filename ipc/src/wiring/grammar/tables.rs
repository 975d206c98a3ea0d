//! Every table of a creature file, key by key.
//!
//! Must never take a key that is not described here.

use super::{Grammar, Key, Kinds, Value};

const fn key(name: &'static str, takes: Value, default: &'static str, about: &'static str) -> Key {
    Key {
        name,
        takes,
        needed: false,
        default,
        about,
    }
}

const fn needed(name: &'static str, takes: Value, about: &'static str) -> Key {
    Key {
        name,
        takes,
        needed: true,
        default: "",
        about,
    }
}

const TIME: Value = Value::Time { positive: true };

/// Highest priority of a layer: above it come the daemon's watchdog at 98, and the kernel's own threads at 99.
pub const PRIORITY_MAX: u64 = 97;

/// Most layer processes attached at once: each maps a page, and iceoryx2 serves 64 readers of one.
pub const LAYERS_MAX: u64 = 32;

/// Most messages a second of a tap that a file may allow: beats are not shorter than a microsecond.
pub const MESSAGES_MAX: u64 = 1_000_000;

/// The whole file.
pub static FILE: Grammar = Grammar {
    what: "the file",
    about: "A creature of subsumed: its body, its layers and its wiring; or the manifest of a layer that joins one",
    keys: &[
        needed(
            "creature",
            Value::Name,
            "the creature's name; in a manifest, the creature to join",
        ),
        key(
            "seed",
            Value::Whole {
                low: 0,
                high: i64::MAX as u64,
            },
            "0",
            "seed of everything random",
        ),
        key("body", Value::Table(&BODY), "", "what joins wires to the world"),
        key(
            "layer",
            Value::Tables(&LAYER),
            "",
            "the layers; levels count up from 0",
        ),
        key("halt", Value::Table(&HALT), "", "how the body halts"),
        key(
            "outsiders",
            Value::Table(&OUTSIDERS),
            "",
            "what other processes may do; nothing but reading if not given",
        ),
        key("executor", Value::Table(&EXECUTOR), "", "how beats are scheduled"),
    ],
    kinds: None,
};

/// `[body]`.
pub static BODY: Grammar = Grammar {
    what: "[body]",
    about: "The body: a kind, the beat of its motor unit, and the kind's own parameters",
    keys: &[
        needed("kind", Value::BodyKind, "what kind of body"),
        key(
            "period",
            TIME,
            "\"20ms\"",
            "time between two beats of the motor unit",
        ),
    ],
    kinds: Some(Kinds::Bodies),
};

/// `[[layer]]`.
pub static LAYER: Grammar = Grammar {
    what: "this [[layer]]",
    about: "The modules that together give one level of competence",
    keys: &[
        needed("name", Value::Name, "the layer's name"),
        needed(
            "level",
            Value::Whole { low: 0, high: 255 },
            "its level; lower levels never rely on higher ones",
        ),
        needed("period", TIME, "time between two beats"),
        key(
            "phase",
            Value::Time { positive: false },
            "\"0ms\"",
            "when the beats lie within the period; shorter than it",
        ),
        key(
            "priority",
            Value::Whole {
                low: 1,
                high: PRIORITY_MAX,
            },
            "",
            "SCHED_FIFO priority, below the watchdog at 98; rate-monotonic if not given",
        ),
        key(
            "cpu",
            Value::Whole { low: 0, high: 1023 },
            "",
            "the processor the layer is bound to; any if not given",
        ),
        key(
            "overrun",
            Value::Word(&["skip", "catch-up", "halt"]),
            "\"skip\"",
            "what happens when a beat runs over its period",
        ),
        key(
            "vital",
            Value::Bit,
            "false",
            "whether the body halts when the layer misses its beats",
        ),
        key(
            "group",
            Value::Name,
            "",
            "layers of one group share a thread; they have one period, phase, priority, processor and way of waking",
        ),
        key(
            "wake",
            Value::Word(&["sleep", "spin"]),
            "\"sleep\"",
            "sleep until the beat, or sleep until shortly before it and spin the rest",
        ),
        key(
            "spin",
            TIME,
            "\"50us\"",
            "how long before the beat spinning begins, with wake = \"spin\"",
        ),
        key(
            "modules",
            Value::Named(&MODULE),
            "",
            "the layer's modules by name",
        ),
        key(
            "wires",
            Value::Wires,
            "",
            "wires into the layer's modules and the body: \"module.output -> module.input, module.input\"",
        ),
        key(
            "suppress",
            Value::Tables(&SUPPRESS),
            "",
            "taps that replace what arrives at an input of a lower level",
        ),
        key(
            "inhibit",
            Value::Tables(&INHIBIT),
            "",
            "taps that silence an output of a lower level",
        ),
    ],
    kinds: None,
};

/// A module of a layer.
pub static MODULE: Grammar = Grammar {
    what: "this module",
    about: "A module: a kind, and the kind's own parameters",
    keys: &[needed("kind", Value::ModuleKind, "what kind of module")],
    kinds: Some(Kinds::Modules),
};

/// A suppressor.
pub static SUPPRESS: Grammar = Grammar {
    what: "this suppressor",
    about: "A suppressor: its messages replace what the input would have got, for the time constant after each",
    keys: &[
        needed("from", Value::Port, "an output of this layer"),
        needed("input", Value::Port, "the input of a lower level that it acts on"),
        needed(
            "time_constant",
            TIME,
            "how long after each message the existing wire is rejected",
        ),
    ],
    kinds: None,
};

/// An inhibitor.
pub static INHIBIT: Grammar = Grammar {
    what: "this inhibitor",
    about: "An inhibitor: the output is silent for the time constant after each of its messages",
    keys: &[
        needed("from", Value::Port, "an output of this layer"),
        needed(
            "output",
            Value::Port,
            "the output of a lower level that it acts on",
        ),
        needed(
            "time_constant",
            TIME,
            "how long after each message the output is silent",
        ),
    ],
    kinds: None,
};

/// `[halt]`.
pub static HALT: Grammar = Grammar {
    what: "[halt]",
    about: "The halt reflex: the channel that stops the actuators, whatever else the layers say",
    keys: &[
        key(
            "reflex",
            Value::Ports,
            "[]",
            "outputs of level 0 whose pulses stop forward motion",
        ),
        key("hold", TIME, "\"500ms\"", "how long one such pulse holds"),
        key(
            "stale",
            TIME,
            "\"200ms\"",
            "a command to the body that is older halts it",
        ),
        key(
            "watchdog_device",
            Value::Path,
            "",
            "a hardware watchdog that is fed while all is well",
        ),
    ],
    kinds: None,
};

/// `[outsiders]`.
pub static OUTSIDERS: Grammar = Grammar {
    what: "[outsiders]",
    about: "What processes beside the daemon may do; the daemon's own user always may plug in. A layer's manifest has \
            \"read\" and \"tap\" only, for its own ports",
    keys: &[
        key(
            "read",
            Value::PortsOrAll,
            "\"*\"",
            "outputs whose wires they may read",
        ),
        key(
            "tap",
            Value::Ports,
            "[]",
            "ports they may tap: inputs may be suppressed, outputs inhibited",
        ),
        key(
            "users",
            Value::Accounts,
            "[]",
            "further users who may plug in, by name or number",
        ),
        key(
            "groups",
            Value::Accounts,
            "[]",
            "groups whose members may plug in, by name or number",
        ),
        key(
            "layers_max",
            Value::Whole {
                low: 0,
                high: LAYERS_MAX,
            },
            "16",
            "most layers attached at once",
        ),
        key(
            "level_max",
            Value::Whole { low: 0, high: 255 },
            "255",
            "highest level an attached layer may claim",
        ),
        key(
            "time_constant_min",
            Value::Time { positive: false },
            "\"0s\"",
            "shortest time constant of their taps",
        ),
        key(
            "time_constant_max",
            TIME,
            "\"60s\"",
            "longest time constant of their taps",
        ),
        key(
            "messages_max",
            Value::Whole {
                low: 1,
                high: MESSAGES_MAX,
            },
            "1000",
            "most messages a second of one of their taps",
        ),
    ],
    kinds: None,
};

/// `[executor]`.
pub static EXECUTOR: Grammar = Grammar {
    what: "[executor]",
    about: "How beats are scheduled",
    keys: &[
        key(
            "policy",
            Value::Word(&["fifo", "deadline"]),
            "\"fifo\"",
            "SCHED_FIFO with priorities, or SCHED_DEADLINE from the periods",
        ),
        key(
            "best_effort",
            Value::Word(&["allow", "refuse"]),
            "\"allow\"",
            "whether to run, marked so, on a host that grants no real-time scheduling",
        ),
        key(
            "spin_share_max",
            Value::Number { low: 0.0, high: 1.0 },
            "0.2",
            "largest share of one processor that layers may spend spinning",
        ),
    ],
    kinds: None,
};
