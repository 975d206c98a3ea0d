//! `allen.hunger`: says whether the battery needs charging.
//!
//! ```text
//!  Full ──battery < low──► Hungry ──battery > enough──► Full        every message of the battery: hungry
//! ```
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter, Port};

const BATTERY: In<f64> = In::at(0);
const HUNGRY: Out<bool> = Out::at(0);

/// The kind `allen.hunger`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Hunger::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.hunger",
    about: "says whether the battery needs charging, with hysteresis",
    diagram: "Full --battery < low--> Hungry --battery > enough--> Full",
    inputs: &[
        Port::new("battery", Kind::Number, "share of the charge that is left")
            .unit("1")
            .between(0.0, 1.0),
    ],
    outputs: &[Port::new("hungry", Kind::Bit, "whether it needs charging")],
    parameters: &[
        Parameter::number(
            "low",
            0.5,
            "less than this is low: what the way home may take is half of it",
        )
        .between(0.0, 1.0)
        .unit("1"),
        Parameter::number("enough", 0.95, "more than this is full")
            .between(0.0, 1.0)
            .unit("1"),
    ],
};

struct Hunger {
    hungry: bool,
    low: f64,
    enough: f64,
}

impl Hunger {
    fn new(settings: &Settings<'_>) -> Hunger {
        Hunger {
            hungry: false,
            low: settings.number("low"),
            enough: settings.number("enough"),
        }
    }
}

impl Module for Hunger {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let Some(battery) = beat.arrived(BATTERY) else {
            return;
        };
        self.hungry = battery < if self.hungry { self.enough } else { self.low };
        beat.emit(HUNGRY, self.hungry);
    }

    fn reset(&mut self) {
        self.hungry = false;
    }

    fn state(&self) -> &'static str {
        if self.hungry { "hungry" } else { "full" }
    }
}
