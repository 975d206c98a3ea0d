//! The catalogue: what kinds of module there are, declared before any of them is built.
//!
//! Must never build or run a module; it only says what ports and parameters a kind has, so that wiring can
//! be checked whole before anything starts.

use std::ops::Range;
use std::path::PathBuf;

use crate::clock::Span;
use crate::message::Kind;
use crate::wire::Limits;

/// A port of a kind of module.
#[derive(Clone, Copy, Debug)]
pub struct Port {
    /// Its name within the module.
    pub name: &'static str,
    /// The kind of message.
    pub kind: Kind,
    /// The unit of the message's numbers (`"m"`, `"rad"`, `"m/s"`, `"1"`); empty if any will do.
    pub unit: &'static str,
    /// Smallest value accepted in any of its numbers.
    pub low: f64,
    /// Largest value accepted in any of its numbers.
    pub high: f64,
    /// One line on what it means.
    pub about: &'static str,
}

impl Port {
    /// A port for any finite numbers, without a unit.
    pub const fn new(name: &'static str, kind: Kind, about: &'static str) -> Port {
        Port {
            name,
            kind,
            unit: "",
            low: f64::MIN,
            high: f64::MAX,
            about,
        }
    }

    /// The same port with a unit.
    pub const fn unit(mut self, unit: &'static str) -> Port {
        self.unit = unit;
        self
    }

    /// The same port, taking only numbers between `low` and `high`.
    pub const fn between(mut self, low: f64, high: f64) -> Port {
        self.low = low;
        self.high = high;
        self
    }

    /// What the port takes.
    pub const fn limits(&self) -> Limits {
        Limits {
            kind: self.kind,
            low: self.low,
            high: self.high,
        }
    }
}

/// The value of a module's parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// A number.
    Number(f64),
    /// A length of time.
    Span(Span),
    /// Yes or no.
    Bit(bool),
    /// A word.
    Text(String),
    /// Some numbers.
    Numbers(Vec<f64>),
    /// Some lengths of time.
    Spans(Vec<Span>),
    /// A text file, if one was named.
    File(Option<Attached>),
}

/// A text file that a parameter names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attached {
    /// Where it was found.
    pub path: PathBuf,
    /// What stood in it when the creature was checked.
    pub text: String,
}

/// What is wrong with a text file that a parameter names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The offending bytes.
    pub at: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
}

/// What a parameter takes, with its default.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    /// A number from `low` to `high`.
    Number {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
        /// Value when not given; must be given if `None`.
        default: Option<f64>,
    },
    /// A time with a unit, longer than zero.
    Span {
        /// Value when not given; must be given if `None`. Zero, which nobody can give, stands for none.
        default: Option<Span>,
    },
    /// `true` or `false`.
    Bit {
        /// Value when not given; must be given if `None`.
        default: Option<bool>,
    },
    /// One of some words.
    Word {
        /// The words.
        words: &'static [&'static str],
        /// Value when not given; must be given if `None`.
        default: Option<&'static str>,
    },
    /// A list of up to `most` numbers, each from `low` to `high`.
    Numbers {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
        /// How many there may be.
        most: usize,
        /// Value when not given; must be given if `None`.
        default: Option<&'static [f64]>,
    },
    /// A list of up to `most` times with a unit; zero is one of them.
    Spans {
        /// How many there may be.
        most: usize,
        /// Value when not given; must be given if `None`.
        default: Option<&'static [Span]>,
    },
    /// The path of a text file, found from the folder of the file that names it. It may be left out.
    File {
        /// Most bytes in it.
        bytes_max: usize,
        /// All that is wrong with its text.
        check: fn(&str) -> Vec<Fault>,
        /// Parameters that say the same in another way: they are not given with it.
        instead_of: &'static [&'static str],
    },
}

impl Takes {
    /// Any finite number, with a default.
    pub const fn number(default: f64) -> Takes {
        Takes::Number {
            low: f64::MIN,
            high: f64::MAX,
            default: Some(default),
        }
    }

    /// The default, if there is one.
    pub fn default(&self) -> Option<Setting> {
        match *self {
            Takes::Number { default, .. } => default.map(Setting::Number),
            Takes::Span { default } => default.map(Setting::Span),
            Takes::Bit { default } => default.map(Setting::Bit),
            Takes::Word { default, .. } => default.map(|w| Setting::Text(w.into())),
            Takes::Numbers { default, .. } => default.map(|n| Setting::Numbers(n.into())),
            Takes::Spans { default, .. } => default.map(|s| Setting::Spans(s.into())),
            Takes::File { .. } => Some(Setting::File(None)),
        }
    }
}

/// A parameter of a kind of module.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub takes: Takes,
    /// Its unit, if it is a number with one.
    pub unit: &'static str,
    /// One line on what it means.
    pub about: &'static str,
}

impl Parameter {
    /// A parameter without a unit.
    pub const fn new(name: &'static str, takes: Takes, about: &'static str) -> Parameter {
        Parameter {
            name,
            takes,
            unit: "",
            about,
        }
    }

    /// Any finite number, with a default.
    pub const fn number(name: &'static str, default: f64, about: &'static str) -> Parameter {
        Parameter::new(name, Takes::number(default), about)
    }

    /// A length of time, with a default.
    pub const fn span(name: &'static str, default: Span, about: &'static str) -> Parameter {
        let default = Some(default);
        Parameter::new(name, Takes::Span { default }, about)
    }

    /// Yes or no, with a default.
    pub const fn bit(name: &'static str, default: bool, about: &'static str) -> Parameter {
        let default = Some(default);
        Parameter::new(name, Takes::Bit { default }, about)
    }

    /// One of some words, with a default.
    pub const fn word(
        name: &'static str,
        words: &'static [&'static str],
        default: &'static str,
        about: &'static str,
    ) -> Parameter {
        let default = Some(default);
        Parameter::new(name, Takes::Word { words, default }, about)
    }

    /// The same parameter, which must be given.
    ///
    /// # Panics
    /// When it takes a file: in a declaration, then, that doesn't compile.
    pub const fn needed(mut self) -> Parameter {
        match &mut self.takes {
            Takes::Number { default, .. } => *default = None,
            Takes::Span { default } => *default = None,
            Takes::Bit { default } => *default = None,
            Takes::Word { default, .. } => *default = None,
            Takes::Numbers { default, .. } => *default = None,
            Takes::Spans { default, .. } => *default = None,
            Takes::File { .. } => panic!("a file may be left out"),
        }
        self
    }

    /// The same parameter, taking only numbers from `least` to `largest`.
    ///
    /// # Panics
    /// When it takes no numbers: in a declaration, then, that doesn't compile.
    pub const fn between(mut self, least: f64, largest: f64) -> Parameter {
        match &mut self.takes {
            Takes::Number { low, high, .. } | Takes::Numbers { low, high, .. } => {
                *low = least;
                *high = largest;
            }
            _ => panic!("only numbers lie between numbers"),
        }
        self
    }

    /// The same parameter with a unit.
    pub const fn unit(mut self, unit: &'static str) -> Parameter {
        self.unit = unit;
        self
    }
}

/// What a kind of module looks like from outside.
#[derive(Clone, Copy, Debug)]
pub struct Declaration {
    /// The kind's name, as `kind = "..."` gives it.
    pub name: &'static str,
    /// One line on what it does.
    pub about: &'static str,
    /// Its transition diagram or formula, with units.
    pub diagram: &'static str,
    /// Input ports, in the order the module knows them.
    pub inputs: &'static [Port],
    /// Output ports, in the order the module knows them.
    pub outputs: &'static [Port],
    /// Parameters, in the order the module knows them.
    pub parameters: &'static [Parameter],
}

/// The reset line that every module has beside its own inputs: a pulse puts it back in its initial state.
pub const RESET: Port = Port::new("reset", Kind::Pulse, "puts the module back in its initial state");

impl Declaration {
    /// The input port called `name`, with its index; the reset line comes after the module's own inputs.
    pub fn input(&self, name: &str) -> Option<(usize, &'static Port)> {
        if name == RESET.name {
            return Some((self.inputs.len(), &RESET));
        }
        self.inputs.iter().enumerate().find(|(_, p)| p.name == name)
    }

    /// The output port called `name`, with its index.
    pub fn output(&self, name: &str) -> Option<(usize, &'static Port)> {
        self.outputs.iter().enumerate().find(|(_, p)| p.name == name)
    }
}

/// The kinds of module and body that a program was built with.
pub trait Catalog {
    /// Every kind of module.
    fn modules(&self) -> Vec<&'static Declaration>;
    /// Every kind of body. Its outputs are sensors, its inputs commands.
    fn bodies(&self) -> Vec<&'static Declaration>;
}
