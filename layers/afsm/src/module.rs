//! A module: one augmented finite state machine (Brooks 1991 §6.2).
//!
//! A module is an enum of states and one `match` in [`Module::step`]. What it sees is its [`Beat`]: the
//! time, its own registers, its own outputs. It cannot see another module, make a wire, ask a clock or wait:
//! there is nothing here to do it with.

use ipc::clock::Time;
use ipc::message::Payload;
use ipc::wire::{Outlet, Register};

use crate::port::{In, Out};

/// One augmented finite state machine.
pub trait Module: Send {
    /// One step: looks at the registers, changes state, emits at most one message on each output port.
    ///
    /// Runs on a real-time thread: it must not allocate, lock, print or loop without bound.
    fn step(&mut self, beat: &mut Beat<'_>);

    /// Back to the initial state: what the reset line does.
    fn reset(&mut self);

    /// The name of the state it is in.
    fn state(&self) -> &'static str;
}

/// What a module sees of the world in one step.
#[derive(Debug)]
pub struct Beat<'b> {
    pub(crate) now: Time,
    pub(crate) inputs: &'b [Register],
    pub(crate) outputs: &'b mut [Outlet],
}

impl Beat<'_> {
    /// The time of this beat.
    #[inline]
    pub fn now(&self) -> Time {
        self.now
    }

    /// The message that arrived since the last step, if one did. Asking is what makes a state look at an
    /// input; a message that arrives while nobody asks is ignored.
    #[inline]
    pub fn arrived<T: Payload>(&self, port: In<T>) -> Option<T> {
        let register = &self.inputs[port.index];
        if register.arrived() {
            self.latest(port)
        } else {
            None
        }
    }

    /// The newest message that ever arrived, however old.
    #[inline]
    pub fn latest<T: Payload>(&self, port: In<T>) -> Option<T> {
        self.inputs[port.index].value()
    }

    /// When the newest message was written to its wire.
    #[inline]
    pub fn stamp<T: Payload>(&self, port: In<T>) -> Option<Time> {
        self.inputs[port.index].stamp()
    }

    /// Emits a message at the end of this beat.
    ///
    /// # Panics
    /// When the step emits twice on one port.
    #[inline]
    pub fn emit<T: Payload>(&mut self, port: Out<T>, message: T) {
        self.outputs[port.index].emit(message);
    }
}
