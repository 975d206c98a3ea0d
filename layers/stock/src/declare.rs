//! Short forms for declaring ports and parameters.
//!
//! Must never give a parameter a range that lets a module compute what is no number from its parameters alone.
//!
//! In units `[in]` stands for the unit of what arrives on `in`.

use ipc::clock::Span;
use ipc::message::Kind;
use ipc::wiring::{Parameter, Port};

/// Largest rate, factor or bound that a parameter takes: far beyond any robot's, and far enough below the
/// largest number that one of them times a message of the same size is still a number.
pub(crate) const NUMBER_MAX: f64 = 1e12;

/// The single output of most modules.
pub(crate) const fn out(kind: Kind, about: &'static str) -> Port {
    Port::new("out", kind, about)
}

/// The single input of many modules.
pub(crate) const fn input(kind: Kind, about: &'static str) -> Port {
    Port::new("in", kind, about)
}

/// A number of either sign with a default.
pub(crate) const fn number(
    name: &'static str,
    default: f64,
    unit: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::number(name, default, about)
        .between(-NUMBER_MAX, NUMBER_MAX)
        .unit(unit)
}

/// A number of either sign that must be given.
pub(crate) const fn needed(name: &'static str, unit: &'static str, about: &'static str) -> Parameter {
    number(name, 0.0, unit, about).needed()
}

/// A number that is not negative, with a default.
pub(crate) const fn positive(
    name: &'static str,
    default: f64,
    unit: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::number(name, default, about)
        .between(0.0, NUMBER_MAX)
        .unit(unit)
}

/// A length of time that must be given.
pub(crate) const fn span(name: &'static str, about: &'static str) -> Parameter {
    Parameter::span(name, Span::ZERO, about).needed()
}

/// A length of time that need not be given; [`Span::ZERO`] if it is not.
pub(crate) const fn span_or_none(name: &'static str, about: &'static str) -> Parameter {
    Parameter::span(name, Span::ZERO, about)
}
