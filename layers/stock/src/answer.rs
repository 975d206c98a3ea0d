//! The outcome of a computation: emitted if it is a message, kept back if it is none.
//!
//! Must never let through what is no finite number: a division by zero or an overflow is silence on the wire,
//! and shows in the module's state until the next sound result.

use afsm::{Beat, Out};
use ipc::message::Payload;

/// How the last computation ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Answer {
    /// There was none yet.
    #[default]
    Waiting,
    /// It was emitted.
    Sound,
    /// It was no finite number and was not emitted.
    Refused,
}

impl Answer {
    /// Emits `value` on `port` if every number in it is finite.
    pub(crate) fn emit<T: Payload>(beat: &mut Beat<'_>, port: Out<T>, value: T) -> Answer {
        if T::KIND.accepts(&value.pack(), f64::MIN, f64::MAX) {
            beat.emit(port, value);
            Answer::Sound
        } else {
            Answer::Refused
        }
    }

    /// The name of the state.
    pub(crate) fn state(self) -> &'static str {
        match self {
            Answer::Waiting => "waiting",
            Answer::Sound => "sound",
            Answer::Refused => "refused",
        }
    }
}
