//! Kinds of module that exist for trying wiring: some that are silent, one that passes on what it hears.
//!
//! Must never do anything that a creature could want: behaviour is for layers.

use afsm::{Beat, In, Kinds, Module, ModuleKind, Out, Settings};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Port};

/// The daemon's kinds and those of this module.
pub fn kinds() -> Kinds {
    daemon::machine::kinds().with([&MOUTH, &BELL, &RELAY])
}

/// A module that never says anything of its own: a wire to put messages on.
pub static MOUTH: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "trial.mouth",
        about: "never says anything of its own: a wire for a scenario to put messages on",
        diagram: "silent",
        inputs: &[],
        outputs: &[Port::new("value", Kind::Number, "what the scenario puts")],
        parameters: &[],
    },
    build: |_: &Settings<'_>| Box::new(Mouth),
};

/// The same for pulses, such as a reset line takes.
pub static BELL: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "trial.bell",
        about: "never rings of its own: a wire for a scenario to put pulses on",
        diagram: "silent",
        inputs: &[],
        outputs: &[Port::new("ring", Kind::Pulse, "when the scenario says so")],
        parameters: &[],
    },
    build: |_: &Settings<'_>| Box::new(Mouth),
};

/// A module that says each message again, one beat later than it came at the latest.
pub static RELAY: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "trial.relay",
        about: "says the newest message again in the beat in which it sees it",
        diagram: "silent --value--> passing: emit value; passing --no value--> silent",
        inputs: &[Port::new("value", Kind::Number, "what is heard")],
        outputs: &[Port::new("value", Kind::Number, "what was heard")],
        parameters: &[],
    },
    build: |_: &Settings<'_>| Box::new(Relay::Silent),
};

struct Mouth;

impl Module for Mouth {
    fn step(&mut self, _: &mut Beat<'_>) {}

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "silent"
    }
}

/// Whether something was heard in this beat.
enum Relay {
    Silent,
    Passing,
}

const HEARD: In<f64> = In::at(0);
const SAID: Out<f64> = Out::at(0);

impl Module for Relay {
    fn step(&mut self, beat: &mut Beat<'_>) {
        *self = match beat.arrived(HEARD) {
            Some(value) => {
                beat.emit(SAID, value);
                Relay::Passing
            }
            None => Relay::Silent,
        };
    }

    fn reset(&mut self) {
        *self = Relay::Silent;
    }

    fn state(&self) -> &'static str {
        match self {
            Relay::Silent => "silent",
            Relay::Passing => "passing",
        }
    }
}
