//! What the OOTland body looks like on wires and in a creature file.
//!
//! Must never hold a value that the world does not take from here.

use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::{Declaration, Parameter, Port};
use truckin::ootland::rules::{SLOTS_MAX, TRUCKS_MAX};
use truckin::wired::driver::WORD_MAX;

/// The input that acts.
pub(super) const ORDER: usize = 0;
/// The output that shows what is free to know.
pub(super) const DIALS: usize = 0;
/// The output that answers orders.
pub(super) const ANSWER: usize = 1;

pub(super) static DECLARATION: Declaration = Declaration {
    name: "ootland",
    about: "a truck in OOTland, the country of the game Truckin', with other trucks; each time slot is a turn",
    diagram: "slot: dealers, trucks before, dials; order -> answer, dials; end of turn or patience: trucks after",
    inputs: &[Port::new(
        "order",
        Kind::Map,
        "number, slot, action or end of turn: see truckin::wired::order",
    )
    .between(-WORD_MAX, WORD_MAX)],
    outputs: &[
        Port::new(
            "dials",
            Kind::Map,
            "what is free to know: see truckin::wired::dials",
        )
        .between(-WORD_MAX, WORD_MAX),
        Port::new("answer", Kind::Map, "what came of the last order").between(-WORD_MAX, WORD_MAX),
    ],
    parameters: &[
        Parameter::number("others", 4.0, "other trucks, drawn from all there are")
            .between(0.0, TRUCKS_MAX as f64 - 1.0)
            .unit("1"),
        Parameter::number("slots", 5000.0, "slots of ten minutes in the game")
            .between(1.0, SLOTS_MAX as f64)
            .unit("1"),
        Parameter::span("slot", Span::millis(500), "least time from one slot to the next"),
        Parameter::span(
            "patience",
            Span::secs(1),
            "how long a turn may take; then the country goes on without the truck",
        ),
        Parameter::number("seed", 0.0, "the seed of country and game; 0: the creature's")
            .between(0.0, 1e15)
            .unit("1"),
        Parameter::number("game", 0.0, "which of the games of the seed")
            .between(0.0, 1e15)
            .unit("1"),
    ],
};
