//! Ports: what a beat's registers and outlets have to tell a tracer.
//!
//! Must never make the usual case pay for the rare one: a beat of a hundred wires comes by here a hundred times and more.

use ipc::wire::{Outlet, Register, Took};
use ipc::wiring::creature::How;

use super::Tracer;
use crate::layer::Command;

impl Tracer {
    /// Register `slot` was gathered: the only time in this beat.
    #[inline(always)]
    pub fn register(&mut self, slot: usize, register: &Register) {
        match register.took() {
            Took::Nothing => {}
            Took::Next => self.saw_next(slot),
            Took::Other => self.look(slot, register),
        }
        if register.tapped() {
            self.suppressors(register);
        }
    }

    /// A message that is not simply the next one.
    #[inline(never)]
    fn look(&mut self, slot: usize, register: &Register) {
        if let Some((number, fate)) = register.looked() {
            self.saw(slot, number, fate);
        }
    }

    #[inline(never)]
    fn suppressors(&mut self, register: &Register) {
        register.tap_looks().for_each(|look| self.tap(&look));
    }

    /// Outlet `slot` was committed, the only time in this beat, outlets in order: whether it had something to say, and
    /// whether it wrote it.
    #[inline(always)]
    pub fn outlet(&mut self, slot: usize, outlet: &Outlet, staged: bool, wrote: bool) {
        if outlet.tapped() {
            self.inhibitors(outlet);
        }
        if wrote {
            self.wrote_next(slot, outlet.kind(), outlet.words());
        } else if staged {
            self.dropped(slot);
        }
    }

    /// Outlet `slot` was committed or handed a message by itself: whether it wrote it, and its words. That may be between
    /// two beats, where nobody hears it.
    pub fn alone(&mut self, slot: usize, outlet: &Outlet, message: Option<(bool, &[f64])>) {
        self.forget();
        self.inhibitors(outlet);
        match message {
            Some((true, words)) => {
                self.wrote(slot, outlet.counts().emitted, &words[..outlet.kind().words()]);
            }
            Some((false, _)) => self.dropped(slot),
            None => {}
        }
    }

    /// The layer obeys `command`.
    pub fn command(&mut self, command: &Command) {
        let (slot, end, how) = match command {
            Command::Suppress(slot, end) => (slot, end, How::Suppress),
            Command::Inhibit(slot, end) => (slot, end, How::Inhibit),
            Command::Release(plug) => return self.released(*plug),
            // Only a layer of a process of its own is connected anew, and nobody records it. Its messages are counted
            // from the beginning.
            Command::Connect(..) => return self.forget(),
        };
        let tap = end.gauge.number();
        self.joined(*slot, tap, how, end.level, end.plug, end.time_constant);
    }

    #[inline(never)]
    fn inhibitors(&mut self, outlet: &Outlet) {
        outlet.tap_looks().for_each(|look| self.tap(&look));
    }
}
