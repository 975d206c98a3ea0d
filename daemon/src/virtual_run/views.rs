//! What can be seen of a run: messages, deliveries, states, taps; and how it looks at its registers for that.
//!
//! Must never change what the creature does: looking takes in what was written, and nothing else.

use afsm::layer::RunningLayer;
use ipc::clock::Time;
use ipc::tap::Window;
use ipc::wire::{Register, TapCounts};
use ipc::wiring::creature::How;

use super::guests::Spot;
use super::{Log, Message, VirtualRun};

/// A tap as it stands.
#[derive(Clone, Copy, Debug)]
pub struct TapView {
    /// Its newest message's window.
    pub window: Option<Window>,
    /// What was counted at it, over all comings of its layer.
    pub counts: TapCounts,
}

impl VirtualRun {
    /// Lets the registers and taps look of every layer of which `chosen` says so, told when it is due, and of
    /// every one with a watched input.
    pub(super) fn look(&mut self, chosen: impl Fn(Option<Time>) -> bool) {
        let now = self.now;
        let all = !self.inputs.is_empty();
        let own = self.machine.stations.iter_mut().zip(&self.due);
        let own = own.map(|(station, due)| (station, *due));
        let guests = self.guests.here.iter_mut().map(|g| (&mut g.station, g.due));
        for (station, due) in own.chain(guests) {
            if all || chosen(due) {
                station.running.look(now);
            } else {
                // Its registers look when it steps; its inhibitors only when others have written again.
                station.running.look_at_inhibitors(now);
            }
        }
        if let Some(body) = &mut self.machine.body
            && (all || chosen(Some(self.body_due)))
        {
            body.motor.look(now);
        }
        for index in 0..self.inputs.len() {
            self.note_delivery(index);
        }
    }

    fn note_delivery(&mut self, index: usize) {
        let Some(register) = self.register(&self.inputs[index].name) else {
            return;
        };
        let (delivered, held) = (register.counts().delivered, register.held());
        let input = &mut self.inputs[index];
        if delivered != input.delivered {
            input.delivered = delivered;
            input.messages.extend(held);
        }
    }

    /// The register behind the input port called `name`.
    pub fn register(&self, name: &str) -> Option<&Register> {
        if let Some((station, input)) = self.guests.policy.input(name) {
            return Some(self.machine.stations[station].running.register(input));
        }
        let (module, port) = name.split_once('.')?;
        if module == ipc::wiring::BODY {
            let body = self.machine.body.as_ref()?;
            let (index, _) = body.motor.declaration().input(port)?;
            return body.motor.register(index);
        }
        self.guests.here.iter().find_map(|guest| {
            let mut before = 0;
            for m in &guest.station.spec.modules {
                if m.name == module {
                    let (index, _) = m.declaration.input(port)?;
                    return Some(guest.station.running.register(before + index));
                }
                before += m.declaration.inputs.len() + 1;
            }
            None
        })
    }

    /// What was written so far.
    pub fn log(&self) -> Option<&Log> {
        self.log.as_ref()
    }

    /// What was delivered so far to the watched input called `name`.
    pub fn delivered(&self, name: &str) -> &[Message] {
        let input = self.inputs.iter().find(|i| i.name == name);
        input.map(|i| i.messages.as_slice()).unwrap_or_default()
    }

    /// The state of the module called `name`, if its layer is here.
    pub fn state_of(&self, name: &str) -> Option<&'static str> {
        let guests = self.guests.here.iter().map(|g| &g.station);
        let mut stations = self.machine.stations.iter().chain(guests);
        stations.find_map(|s| s.running.state_of(name))
    }

    /// The tap from one port to another, if there ever was one.
    pub fn tap(&self, from: &str, to: &str) -> Option<TapView> {
        let taps = self.guests.taps.iter().filter(|t| t.from == from && t.to == to);
        let mut view = None;
        for tap in taps {
            let at = |running: &RunningLayer, port: usize| match tap.how {
                How::Suppress => running.register(port).window_of(&tap.gauge),
                How::Inhibit => running.outlet(port).window_of(&tap.gauge),
            };
            let window = match &tap.place {
                Spot::Own((station, port)) => at(&self.machine.stations[*station].running, *port),
                Spot::Guest(layer, port) => {
                    let owner = self.guests.here.iter().find(|g| g.plug.layer == *layer);
                    owner.and_then(|g| at(&g.station.running, *port))
                }
                Spot::Body(input) => {
                    let body = self.machine.body.as_ref();
                    let register = body.and_then(|b| b.motor.register(*input));
                    register.and_then(|r| r.window_of(&tap.gauge))
                }
            };
            let counts = tap.gauge.counts();
            let before: TapView = view.unwrap_or(TapView {
                window: None,
                counts: TapCounts::default(),
            });
            view = Some(TapView {
                window: window.or(before.window),
                counts: TapCounts {
                    delivered: before.counts.delivered + counts.delivered,
                    rejected: before.counts.rejected + counts.rejected,
                    faults: before.counts.faults + counts.faults,
                },
            });
        }
        view
    }
}
