//! Layers that join the running creature: checked once more, joined through the layers' hands, let go when
//! their process leaves in whatever way.
//!
//! Must never wait for a layer process, nor let anything it says reach a real-time thread unchecked.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use afsm::layer::{Command, Hand};
use ipc::clock::{self, Span, Time};
use ipc::control::{Plug, PlugTap};
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, Reader, TapGauge};
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::Directory;

use crate::events::Events;
use crate::flow::Flow;
use crate::policy::Policy;

/// How long a layer that broke the policy is kept out.
pub const BARRED: Span = Span::secs(10);

/// Most layers kept out at once: as many as may be attached.
const BARRED_MAX: usize = 32;

/// An attached layer, as its connection knows it.
#[derive(Debug)]
pub struct Joined {
    /// Its number.
    pub number: u32,
    /// Set when it is let go against its will.
    pub dismissed: Arc<AtomicBool>,
}

/// A tap that an attached layer holds.
#[derive(Clone, Debug)]
pub struct AttachedTap {
    /// As asked for.
    pub tap: PlugTap,
    /// Where what happens at it is counted.
    pub gauge: Arc<TapGauge>,
    /// Its messages.
    pub reader: Reader,
}

/// An attached layer.
#[derive(Clone, Debug)]
pub struct Attached {
    /// Its number.
    pub number: u32,
    /// As asked for.
    pub plug: Plug,
    /// Its wires.
    pub page: Arc<Page>,
    /// Its taps.
    pub taps: Vec<AttachedTap>,
    /// Set when it is let go against its will: its connection is closed then.
    pub dismissed: Arc<AtomicBool>,
    flows: Vec<Flow>,
}

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
        let attached = self.attached();
        self.policy.directory_with(attached.iter().map(|a| &a.plug))
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
        let attached = self.attached();
        let reasons = self
            .policy
            .reasons_against(plug, attached.iter().map(|a| &a.plug));
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
        if state.attached.len() >= self.policy.outsiders().layers_max {
            return Err(vec!["the most layers allowed are attached".into()]);
        }
        if state.attached.iter().any(|a| a.plug.layer == plug.layer) {
            return Err(vec![format!("a layer {:?} is attached already", plug.layer)]);
        }
        state.last += 1;
        let number = state.last;
        let mut taps = Vec::new();
        for tap in &plug.taps {
            taps.push(self.join(&mut state, number, plug, tap, &page)?);
        }
        let dismissed = Arc::new(AtomicBool::new(false));
        let now = clock::monotonic();
        state.attached.push(Attached {
            number,
            plug: plug.clone(),
            page,
            flows: taps.iter().map(|t| Flow::new(&t.reader, now)).collect(),
            taps,
            dismissed: dismissed.clone(),
        });
        state.version += 1;
        Ok(Joined { number, dismissed })
    }

    fn join(
        &self,
        state: &mut State,
        number: u32,
        plug: &Plug,
        tap: &PlugTap,
        page: &Arc<Page>,
    ) -> Result<AttachedTap, Vec<String>> {
        let gauge = Arc::new(TapGauge::numbered(state.tap_number()));
        let joined = self.policy.join(number, plug, tap, page, gauge);
        let (station, command) = (joined.station, joined.command);
        if state.hands[station].commands.push(command).is_err() {
            for hand in &mut state.hands {
                let _ = hand.commands.push(Command::Release(number));
            }
            return Err(vec![format!(
                "the layer of {} does not take up taps; is it beating?",
                tap.to
            )]);
        }
        Ok(AttachedTap {
            tap: tap.clone(),
            gauge: joined.gauge,
            reader: joined.reader,
        })
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
                        breaches.push((None, layer.clone(), tap.tap.from.clone(), text));
                    }
                    if let Some(text) = flow.flood(tap.reader.number(), most, now) {
                        let text = format!("policy breach: layer {layer} floods {}: {text}", tap.tap.from);
                        attached.dismissed.store(true, Ordering::Relaxed);
                        breaches.push((Some(attached.number), layer.clone(), tap.tap.from.clone(), text));
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
        }
        for (number, layer, wire, text) in breaches {
            self.events.note_wires("policy", Some(&layer), &[wire], text);
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
        for hand in &mut state.hands {
            // A full ring belongs to a layer that does not beat: its taps run out by themselves.
            let _ = hand.commands.push(Command::Release(number));
        }
        drop(state);
        let Plug { layer, pid, .. } = &attached.plug;
        let longest = attached
            .plug
            .taps
            .iter()
            .map(|t| t.time_constant)
            .max()
            .unwrap_or(Span::ZERO);
        let text = format!("layer {layer} (pid {pid}) {why}; its taps run out within {longest}");
        let taps = tapped(&attached.plug);
        self.events.note_wires("layer", Some(layer), &taps, text);
    }
}

/// The ports that a layer taps, each once, by name.
fn tapped(plug: &Plug) -> Vec<String> {
    let mut ports: Vec<String> = plug.taps.iter().map(|tap| tap.to.clone()).collect();
    ports.sort();
    ports.dedup();
    ports
}
