//! The grammar of creature files: every table with every key, what it takes and what it means.
//!
//! Read twice: the reader takes exactly these keys with exactly these ranges, and the
//! schema for editors ([`super::schema`]) is printed from them, so that neither can know a key that the other does not.
//!
//! Must never hold a rule that compares two values: those are the checker's.

mod tables;

pub use tables::{
    BODY, EXECUTOR, FILE, HALT, INHIBIT, LAYER, LAYERS_MAX, MESSAGES_MAX, MODULE, OUTSIDERS, PRIORITY_MAX,
    SUPPRESS,
};

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

impl Grammar {
    /// The key called `name`.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|k| k.name == name)
    }
}
