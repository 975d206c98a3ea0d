//! The grammar of creature files: every table with every key, what it takes and what it means.
//!
//! Read twice: the reader ([`super::read`]) takes exactly these keys with exactly these ranges, and the
//! schema for editors ([`super::schema`]) is printed from them, so that neither can know a key that the other does not.
//!
//! Must never hold a rule that compares two values: those are the checker's.

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// A name: letters, digits, '-' and '_'.
    Name,
    /// The name of a kind of module.
    ModuleKind,
    /// The name of a kind of body.
    BodyKind,
    /// A whole number from `low` to `high`.
    Whole {
        /// Smallest.
        low: u64,
        /// Largest.
        high: u64,
    },
    /// A number from `low` to `high`.
    Number {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// A time with a unit; longer than zero if `positive`.
    Time {
        /// Whether zero is refused.
        positive: bool,
    },
    /// `true` or `false`.
    Bit,
    /// One of some words.
    Word(&'static [&'static str]),
    /// An absolute path.
    Path,
    /// A port: `module.port`.
    Port,
    /// A list of ports.
    Ports,
    /// A list of ports, or `"*"` for all.
    PortsOrAll,
    /// A list of wires: `from.output -> to.input, to.input`.
    Wires,
    /// A list of users or groups, by name or by number.
    Accounts,
    /// A list of tables.
    Tables(&'static Grammar),
    /// A table.
    Table(&'static Grammar),
    /// Tables by name.
    Named(&'static Grammar),
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// What it takes.
    pub takes: Value,
    /// Whether it must be given.
    pub needed: bool,
    /// What it is when not given, as it would stand in a file; empty if that is nothing.
    pub default: &'static str,
    /// What it means.
    pub about: &'static str,
}

/// A kind of table.
#[derive(Clone, Copy, Debug)]
pub struct Grammar {
    /// How errors call the table.
    pub what: &'static str,
    /// What it means.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
    /// Which kinds give it further keys, if any do.
    pub kinds: Option<Kinds>,
}

/// Whose parameters a table takes beside its own keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinds {
    /// Those of its kind of module.
    Modules,
    /// Those of its kind of body.
    Bodies,
}

impl Value {
    /// How such a value looks in a file.
    pub fn example(&self) -> String {
        match self {
            Value::Name | Value::ModuleKind | Value::BodyKind => "\"...\"".into(),
            Value::Whole { low, .. } => low.to_string(),
            Value::Number { low, .. } => low.to_string(),
            Value::Time { .. } => "\"20ms\"".into(),
            Value::Bit => "true".into(),
            Value::Word(words) => format!("{:?}", words[0]),
            Value::Path => "\"/...\"".into(),
            Value::Port => "\"module.port\"".into(),
            Value::Ports | Value::PortsOrAll => "[\"module.port\"]".into(),
            Value::Wires => "[\"module.output -> module.input\"]".into(),
            Value::Accounts | Value::Tables(_) => "[...]".into(),
            Value::Table(_) | Value::Named(_) => "{ ... }".into(),
        }
    }
}

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
    about: "What processes beside the daemon may do; the daemon's own user always may plug in",
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

impl Grammar {
    /// The key called `name`.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|k| k.name == name)
    }
}
