//! `delay`: every message again, a fixed time later.
//!
//! ```text
//!  Empty ──in, stamped s / due := s + by──► Holding ──timer due / out := in──► Empty
//!                                             │  64 in flight
//!                                             └──► Full: a message that arrives now is lost
//! ```
//! The delay counts from the moment a message was written to its wire, so between two wires it is exactly `by` if
//! that is a whole number of beats, and else less than a beat more; it is never less than one beat. Messages due
//! at one beat overwrite each other: the newest is emitted.

use afsm::{Beat, In, Module, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Map, Payload, Polar, Pose, Pulse, Vector};
use ipc::wiring::{Parameter, Port};

use crate::declare::{input, out, span};
use crate::family::family;

/// Most messages in flight: at beats of 10 ms and a message every beat, 0.64 s; for sonar maps, one a second, a
/// minute.
pub const DELAYED_MAX: usize = 64;

const ABOUT: &str = "emits every message again, a fixed time after it was written";
const DIAGRAM: &str = "Empty --in, written at s--> Holding --timer s + by/out := in--> Empty\n\
    Holding --64 in flight--> Full: a message that arrives now is lost";

family!(Delay:
    "delay" f64, "delay.bit" bool, "delay.vector" Vector, "delay.polar" Polar,
    "delay.pulse" Pulse, "delay.map" Map, "delay.pose" Pose,
);

struct Delay<T> {
    by: Span,
    /// A ring: `count` messages from `first` on, oldest first.
    flight: [Option<(Time, T)>; DELAYED_MAX],
    first: usize,
    count: usize,
}

impl<T: Payload> Delay<T> {
    const INPUTS: &'static [Port] = &[input(T::KIND, "what to delay")];
    const OUTPUTS: &'static [Port] = &[out(T::KIND, "the same, later")];
    const PARAMETERS: &'static [Parameter] = &[span("by", "how much later")];
    const IN: In<T> = In::at(0);
    const OUT: Out<T> = Out::at(0);

    fn new(settings: &Settings<'_>) -> Delay<T> {
        Delay {
            by: settings.span("by"),
            flight: [None; DELAYED_MAX],
            first: 0,
            count: 0,
        }
    }

    fn put(&mut self, due: Time, message: T) {
        if self.count < DELAYED_MAX {
            self.flight[(self.first + self.count) % DELAYED_MAX] = Some((due, message));
            self.count += 1;
        }
    }

    /// The newest of all that are due at `now`; they leave.
    fn take(&mut self, now: Time) -> Option<T> {
        let mut newest = None;
        while let Some((due, message)) = self.flight[self.first]
            && due <= now
        {
            newest = Some(message);
            self.flight[self.first] = None;
            self.first = (self.first + 1) % DELAYED_MAX;
            self.count -= 1;
        }
        newest
    }
}

impl<T: Payload + Send> Module for Delay<T> {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let due_before = self.take(beat.now());
        if let (Some(message), Some(stamp)) = (beat.arrived(Self::IN), beat.stamp(Self::IN)) {
            self.put(stamp + self.by, message);
        }
        if let Some(message) = self.take(beat.now()).or(due_before) {
            beat.emit(Self::OUT, message);
        }
    }

    fn reset(&mut self) {
        self.flight = [None; DELAYED_MAX];
        (self.first, self.count) = (0, 0);
    }

    fn state(&self) -> &'static str {
        match self.count {
            0 => "empty",
            DELAYED_MAX => "full",
            _ => "holding",
        }
    }
}
