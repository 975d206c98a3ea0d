//! The rules of creature files and manifests, each with the short code that its errors carry.
//!
//! Must never change a code once released: scripts match on them. Every rule has a bad file of its own in
//! `ipc/tests/bad`, and a test makes sure of it.

use serde::Serialize;

macro_rules! rules {
    ($($(#[doc = $about:literal])+ $name:ident = $code:literal,)+) => {
        /// What an error is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Rule {
            $($(#[doc = $about])+ $name,)+
        }

        /// Every rule there is.
        pub const RULES: &[Rule] = &[$(Rule::$name),+];

        impl Rule {
            /// The rule's code, as errors show it.
            pub const fn code(self) -> &'static str {
                match self {
                    $(Rule::$name => $code),+
                }
            }

            /// One line on what the rule demands.
            pub const fn about(self) -> &'static str {
                match self {
                    $(Rule::$name => concat!($($about),+)),+
                }
            }
        }
    };
}

rules! {
    /// A file is not longer than 4 MiB, and one that it names not longer than its key takes.
    FileTooLong = "file-too-long",
    /// A file is text in UTF-8.
    NotText = "not-text",
    /// A file is TOML.
    Syntax = "syntax",
    /// A key stands once in a table, and a table once in a file.
    DuplicateKey = "duplicate-key",
    /// Every key is one that its table takes.
    UnknownKey = "unknown-key",
    /// Keys without a default are given.
    MissingKey = "missing-key",
    /// A value is of the type its key takes.
    WrongType = "wrong-type",
    /// Where one of some words is expected, it is one of them.
    UnknownWord = "unknown-word",
    /// A number lies in its range.
    OutOfRange = "out-of-range",
    /// A number is finite.
    NotFinite = "not-finite",
    /// A time is a number with a unit.
    BadTime = "bad-time",
    /// A period, time constant or other length of time is longer than zero.
    NotPositive = "not-positive",
    /// A name is made of letters, digits, '-' and '_'.
    BadName = "bad-name",
    /// The name of the body is no module's.
    ReservedName = "reserved-name",
    /// The path of a device is absolute.
    BadPath = "bad-path",
    /// A file that a key names is there and can be read.
    MissingFile = "missing-file",
    /// A file that a key names holds what the key takes.
    BadFile = "bad-file",
    /// Of keys that say the same in two ways one is given.
    ExclusiveKeys = "exclusive-keys",
    /// A port is written as `module.port`.
    BadPort = "bad-port",
    /// A wire is written as `from.output -> to.input`.
    BadWire = "bad-wire",
    /// There is at least one layer.
    NoLayer = "no-layer",
    /// A file has at most 1,024 layers.
    TooManyLayers = "too-many-layers",
    /// A creature has no more outputs than wires fit into its page.
    TooManyWires = "too-many-wires",
    /// A user or group is a name or a number.
    BadAccount = "bad-account",
    /// The kind of a module or body is one the program was built with.
    UnknownKind = "unknown-kind",
    /// A layer has a name of its own.
    DuplicateLayer = "duplicate-layer",
    /// A module has a name of its own in the whole creature.
    DuplicateModule = "duplicate-module",
    /// A list names nothing twice.
    DuplicateEntry = "duplicate-entry",
    /// A port belongs to a module that is there.
    UnknownModule = "unknown-module",
    /// A module has the port that is named.
    UnknownPort = "unknown-port",
    /// The two ends of a wire carry the same type of message.
    TypeMismatch = "type-mismatch",
    /// The two ends of a wire carry numbers in the same unit.
    UnitMismatch = "unit-mismatch",
    /// An input has one writer; others join as taps.
    TwoWriters = "two-writers",
    /// A layer reads from its own level and below.
    HigherSource = "higher-source",
    /// A layer's wires end at its own modules or at the body.
    NotOwnInput = "not-own-input",
    /// Layers of one level do not read from each other in a circle.
    LayerCycle = "layer-cycle",
    /// Something can reach every module.
    Unreachable = "unreachable",
    /// Modules that feed only each other contain one that can speak first.
    DeadLoop = "dead-loop",
    /// A tap comes from an output of the layer that declares it.
    NotOwnOutput = "not-own-output",
    /// A tap points to a lower level.
    TapUpward = "tap-upward",
    /// Nothing taps the halt channel.
    HaltChannel = "halt-channel",
    /// Sensors are not inhibited.
    SensorTap = "sensor-tap",
    /// A port has no more taps than fit on it.
    TooManyTaps = "too-many-taps",
    /// A reflex is an output of level 0 that carries a pulse.
    BadReflex = "bad-reflex",
    /// The phase is shorter than the period.
    PhaseTooLong = "phase-too-long",
    /// A lower level does not run at a lower priority than a higher one that beats no faster.
    PriorityInversion = "priority-inversion",
    /// Layers of one group beat together: same period, phase, priority, processor and way of waking.
    GroupDiffers = "group-differs",
    /// The time spent spinning is given with `wake = "spin"`, and is shorter than the period.
    BadSpin = "bad-spin",
    /// No processor spins for more than its share.
    SpinShare = "spin-share",
    /// Under policy deadline layers have neither priority nor processor.
    DeadlinePolicy = "deadline-policy",
    /// The shortest allowed time constant is not longer than the longest.
    LimitsCrossed = "limits-crossed",
    /// Outsiders tap ports of modules, not of the body.
    BodyClosed = "body-closed",
    /// A manifest holds one layer and nothing that belongs to the creature.
    NotInManifest = "not-in-manifest",
    /// A layer from outside stays within the highest level allowed.
    LevelTooHigh = "level-too-high",
    /// A layer from outside reads wires that the creature opens.
    NotReadable = "not-readable",
    /// A layer from outside taps ports that the creature opens.
    NotOpen = "not-open",
    /// A tap from outside has a time constant within the allowed limits.
    TimeConstantLimits = "time-constant-limits",
}

impl Serialize for Rule {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.code())
    }
}

impl std::fmt::Display for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.code())
    }
}
