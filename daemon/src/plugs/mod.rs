//! Layers that join the running creature: checked once more, joined through the layers' hands, let go when
//! their process leaves in whatever way.
//!
//! A tap on a layer of the daemon's own is joined by a command to its beating thread. A tap on a port of another
//! attached layer is joined by that layer's process, which is told so in an order ([`orders`]); until it has
//! answered, and whenever it is gone, the tap waits. Both are checked by the same policy.
//!
//! Must never wait for a layer process, nor let anything it says reach a real-time thread unchecked.

mod attached;
pub mod orders;
mod others;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use afsm::layer::{Command, Hand};
use ipc::clock::{self, Span, Time};
use ipc::control::{Plug, PlugTap};
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, TapCounts, TapGauge};
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::Directory;

use crate::events::Events;
use crate::flow::Flow;
use crate::policy::{Policy, settled, tap_end};
use orders::Orders;

pub use attached::{Attached, AttachedTap, Joined};

/// How long a layer that broke the policy is kept out.
pub const BARRED: Span = Span::secs(10);

/// Most layers kept out at once: as many as may be attached.
const BARRED_MAX: usize = 32;

/// The layers attached, and how to reach into those of the creature.
pub struct Plugs {
    policy: Policy,
    state: Mutex<State>,
    events: Arc<Events>,
}

#[derive(Default)]
struct State {
    hands: Vec<Hand>,
    attached: Vec<Attached>,
    last: u32,
    version: u64,
    /// Number of the newest tap, those of the creature file included.
    tap: u16,
    /// Layers that broke the policy, by name, and until when they are not let in again.
    barred: Vec<(String, Time)>,
}

impl State {
    /// The layers attached, as the policy asks for them.
    fn present(&self) -> impl Iterator<Item = (u32, &Plug)> {
        self.attached.iter().map(|a| (a.number, &a.plug))
    }

    /// The next tap's number. It comes round after 65,535 taps; one that old has long left.
    fn tap_number(&mut self) -> u16 {
        self.tap = self.tap.checked_add(1).unwrap_or(1);
        self.tap
    }
}

impl Plugs {
    /// Nobody attached yet.
    pub fn new(creature: Creature, directory: Directory, hands: Vec<Hand>, events: Arc<Events>) -> Plugs {
        let filed: usize = creature.layers.iter().map(|l| l.taps.len()).sum();
        let state = Mutex::new(State {
            hands,
            version: 1,
            tap: filed as u16,
            ..State::default()
        });
        Plugs {
            policy: Policy::new(creature, directory),
            state,
            events,
        }
    }

    /// What the creature shows to newcomers, attached layers included.
    pub fn directory(&self) -> Directory {
        self.policy.directory_with(self.lock().present())
    }

    /// The layers attached now.
    pub fn attached(&self) -> Vec<Attached> {
        self.lock().attached.clone()
    }

    /// Changes whenever a layer comes or goes.
    pub fn version(&self) -> u64 {
        self.lock().version
    }

    /// What the page draws has changed by itself: another floor.
    pub fn picture_changed(&self) {
        self.lock().version += 1;
    }

    /// Drops what the layers have let go of. Call it now and then.
    pub fn sweep(&self) {
        for hand in &mut self.lock().hands {
            while hand.returned.pop().is_ok() {}
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().expect("nobody panics holding the plugs")
    }

    /// Attaches a layer.
    ///
    /// # Errors
    /// Every reason why not.
    pub fn attach(&self, plug: Plug, domain: &Domain) -> Result<Joined, Vec<String>> {
        let plug = settled(plug);
        let result = self.try_attach(&plug, domain);
        let (layer, pid, taps) = (plug.layer.clone(), plug.pid, tapped(&plug));
        match &result {
            Ok(_) => {
                let text = format!("layer {layer} (pid {pid}) attached");
                self.events.note_wires("layer", Some(&layer), &taps, text);
            }
            Err(reasons) => {
                let text = format!("layer {layer} (pid {pid}) refused: {}", reasons.join("; "));
                self.events.note("layer", Some(&layer), text);
            }
        }
        result
    }

    fn try_attach(&self, plug: &Plug, domain: &Domain) -> Result<Joined, Vec<String>> {
        if self.lock().barred.iter().any(|(name, _)| *name == plug.layer) {
            let reason = format!(
                "layer {:?} broke the policy; it may come back {BARRED} after",
                plug.layer
            );
            return Err(vec![reason]);
        }
        let reasons = self.policy.reasons_against(plug, self.lock().present());
        if !reasons.is_empty() {
            return Err(reasons);
        }
        // Mapping may take a while; nothing is locked meanwhile.
        let page = domain.map(&plug.owner).map_err(|e| vec![e.to_string()])?;
        if page.len() < plug.outputs.len() {
            return Err(vec![format!(
                "{} outputs are announced, {} wires shared",
                plug.outputs.len(),
                page.len()
            )]);
        }
        let mut state = self.lock();
        // Others may have come or gone meanwhile.
        let reasons = self.policy.reasons_against(plug, state.present());
        if !reasons.is_empty() {
            return Err(reasons);
        }
        state.last += 1;
        let number = state.last;
        let mut taps = Vec::new();
        for tap in &plug.taps {
            match self.join(&mut state, number, plug, tap, &page) {
                Ok(tap) => taps.push(tap),
                Err(reason) => {
                    state.release(number, &taps, clock::monotonic());
                    return Err(vec![reason]);
                }
            }
        }
        let (dismissed, orders) = (Arc::new(AtomicBool::new(false)), Arc::new(Orders::default()));
        let now = clock::monotonic();
        state.attached.push(Attached {
            number,
            plug: plug.clone(),
            page,
            flows: taps.iter().map(|t| Flow::new(&t.reader, now)).collect(),
            taps,
            dismissed: dismissed.clone(),
            orders: orders.clone(),
        });
        self.introduce(&mut state, now);
        state.version += 1;
        Ok(Joined {
            number,
            dismissed,
            orders,
        })
    }

    /// Joins a tap of a newcomer, or has it joined.
    fn join(
        &self,
        state: &mut State,
        number: u32,
        plug: &Plug,
        tap: &PlugTap,
        page: &Arc<Page>,
    ) -> Result<AttachedTap, String> {
        let gauge = Arc::new(TapGauge::numbered(state.tap_number()));
        let end = tap_end(number, plug, tap, page, gauge.clone());
        let mut joining = AttachedTap {
            tap: tap.clone(),
            gauge,
            reader: end.reader.clone(),
            at: None,
            joined: true,
            before: TapCounts::default(),
        };
        match self.policy.place(tap.how, &tap.to) {
            Some((station, port)) => {
                let command = Command::join(tap.how, port, end);
                let commands = &mut state.hands[station].commands;
                commands
                    .push(command)
                    .map_err(|_| format!("the layer of {} does not take up taps; is it beating?", tap.to))?;
            }
            None => state.have_joined(number, plug, &mut joining, clock::monotonic()),
        }
        Ok(joining)
    }

    /// Looks whether the attached layers keep to the policy: one that floods a tap is let go and not let in again
    /// for a while; one whose messages are none is named. Call it ten times a second.
    pub fn police(&self, now: Time) {
        let mut breaches = Vec::new();
        let most = self.policy.outsiders().messages_max;
        {
            let state = &mut *self.lock();
            state.barred.retain(|(_, until)| *until > now);
            for attached in &mut state.attached {
                for (tap, flow) in attached.taps.iter().zip(&mut attached.flows) {
                    let layer = &attached.plug.layer;
                    if let Some(text) = flow.garbage(&tap.gauge, now) {
                        let text = format!("policy breach: layer {layer}: {text} on {}", tap.tap.from);
                        breaches.push((None, layer.clone(), vec![tap.tap.from.clone()], text));
                    }
                    if let Some(text) = flow.flood(tap.reader.number(), most, now) {
                        let text = format!("policy breach: layer {layer} floods {}: {text}", tap.tap.from);
                        attached.dismissed.store(true, Ordering::Relaxed);
                        breaches.push((
                            Some(attached.number),
                            layer.clone(),
                            vec![tap.tap.from.clone()],
                            text,
                        ));
                        break;
                    }
                }
            }
            let flooding = breaches.iter().filter(|(number, ..)| number.is_some());
            for (_, layer, ..) in flooding {
                if state.barred.len() < BARRED_MAX {
                    state.barred.push((layer.clone(), now + BARRED));
                }
            }
            // Who was stopped for a while may come back at once.
            for attached in state.attached.iter().filter(|a| a.orders.overdue(now)) {
                let layer = &attached.plug.layer;
                let text = format!(
                    "policy breach: layer {layer} has not answered an order within {}",
                    orders::ORDER_TIME
                );
                attached.dismissed.store(true, Ordering::Relaxed);
                breaches.push((Some(attached.number), layer.clone(), Vec::new(), text));
            }
        }
        for (number, layer, wires, text) in breaches {
            self.events.note_wires("policy", Some(&layer), &wires, text);
            if let Some(number) = number {
                self.detach(number, "was let go");
            }
        }
    }

    /// Lets an attached layer go, for the reason given.
    pub fn detach(&self, number: u32, why: &str) {
        let mut state = self.lock();
        let Some(index) = state.attached.iter().position(|a| a.number == number) else {
            return;
        };
        let attached = state.attached.remove(index);
        state.version += 1;
        let now = clock::monotonic();
        state.release(number, &attached.taps, now);
        let waiting = state.miss(&attached.plug, now);
        drop(state);
        let Plug { layer, pid, .. } = &attached.plug;
        let longest = attached.plug.taps.iter().map(|t| t.time_constant).max();
        let longest = longest.unwrap_or(Span::ZERO);
        let text = format!("layer {layer} (pid {pid}) {why}; its taps run out within {longest}");
        let taps = tapped(&attached.plug);
        self.events.note_wires("layer", Some(layer), &taps, text);
        for (other, port, text) in waiting {
            self.events.note_wires("layer", Some(&other), &[port], text);
        }
    }
}

/// The ports that a layer taps, each once, by name.
fn tapped(plug: &Plug) -> Vec<String> {
    let mut ports: Vec<String> = plug.taps.iter().map(|tap| tap.to.clone()).collect();
    ports.sort();
    ports.dedup();
    ports
}
