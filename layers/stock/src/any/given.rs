//! Messages given as parameters: how `value` and `values` read for each type.
//!
//! Must never make a message that its type would not accept: what the checker let through fits.
//!
//! | type | `value` | `values` |
//! | --- | --- | --- |
//! | number | `1.5` | `[1.5, 2.0]`, one for each message |
//! | bit | `true` | `[1, 0]`, one for each message, 0 is false |
//! | vector, polar, pose | `[x, y]` | `[x, y, x, y]`, one message after the other |
//! | map | up to twelve ranges | twelve for each message |
//! | pulse | none | none |
//!
//! Numbers missing at the end of a message are 0.

use afsm::Settings;
use ipc::message::{Kind, Payload, SONARS, WORDS_MAX};
use ipc::wiring::{Parameter, Takes};

/// Most times, and most messages, in the lists of one source; a longer story is told by several sources.
pub const MESSAGES_MAX: usize = 256;

/// The parameter `value` for messages of `kind`.
pub(crate) const fn value(kind: Kind) -> Parameter {
    let takes = match kind {
        Kind::Bit => Takes::Bit { default: None },
        Kind::Number | Kind::Pulse => Takes::Number {
            low: f64::MIN,
            high: f64::MAX,
            default: None,
        },
        Kind::Vector | Kind::Polar | Kind::Pose | Kind::Map => Takes::Numbers {
            low: f64::MIN,
            high: f64::MAX,
            most: kind.words(),
            default: None,
        },
    };
    Parameter::new("value", takes, "the message; numbers missing at its end are 0")
}

/// The parameter `values` for messages of `kind`.
pub(crate) const fn values(kind: Kind) -> Parameter {
    let (low, high) = match kind {
        Kind::Bit => (0.0, 1.0),
        _ => (f64::MIN, f64::MAX),
    };
    let default: &[f64] = match kind {
        Kind::Bit => &[1.0],
        _ => &[0.0],
    };
    Parameter::new(
        "values",
        Takes::Numbers {
            low,
            high,
            most: MESSAGES_MAX * if matches!(kind, Kind::Map) { SONARS } else { 3 },
            default: Some(default),
        },
        "the numbers of the messages, one message after the other; round again at the end",
    )
}

/// The message given as `value`.
pub(crate) fn message<T: Payload>(settings: &Settings<'_>) -> T {
    match T::KIND {
        Kind::Pulse => assemble(&[]),
        Kind::Bit => assemble(&[f64::from(u8::from(settings.bit("value")))]),
        Kind::Number => assemble(&[settings.number("value")]),
        Kind::Vector | Kind::Polar | Kind::Pose | Kind::Map => assemble(settings.numbers("value")),
    }
}

/// The messages given as `values`; there is at least one.
pub(crate) fn messages<T: Payload>(settings: &Settings<'_>) -> Box<[T]> {
    let words = match T::KIND {
        Kind::Pulse => &[],
        _ => settings.numbers("values"),
    };
    if words.is_empty() {
        return [assemble(&[])].into();
    }
    words.chunks(T::KIND.words()).map(assemble).collect()
}

fn assemble<T: Payload>(numbers: &[f64]) -> T {
    let mut words = [0.0; WORDS_MAX];
    words[..numbers.len()].copy_from_slice(numbers);
    T::unpack(&words)
}
