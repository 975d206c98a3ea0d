//! Layers that join the running creature: checked once more, joined through the layers' hands, let go when
//! their process leaves in whatever way.
//!
//! Must never wait for a layer process, nor let anything it says reach a real-time thread unchecked.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use afsm::layer::{Command, Hand};
use ipc::clock::Span;
use ipc::control::{Plug, PlugTap};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, Reader, TapEnd, TapGauge};
use ipc::wiring::creature::{Creature, How};
use ipc::wiring::directory::Directory;

use crate::events::Events;

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
}

/// Where a port of the creature is found: which layer, and which register or outlet of it.
type Places = HashMap<String, (usize, usize)>;

/// The layers attached, and how to reach into those of the creature.
pub struct Plugs {
    creature: Creature,
    directory: Directory,
    inputs: Places,
    outputs: Places,
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
        let (mut inputs, mut outputs) = (Places::new(), Places::new());
        for (station, layer) in creature.layers.iter().enumerate() {
            let (mut input, mut output) = (0, 0);
            for module in &layer.modules {
                for port in module.declaration.inputs {
                    inputs.insert(format!("{}.{}", module.name, port.name), (station, input));
                    input += 1;
                }
                inputs.insert(format!("{}.reset", module.name), (station, input));
                input += 1;
                for port in module.declaration.outputs {
                    outputs.insert(format!("{}.{}", module.name, port.name), (station, output));
                    output += 1;
                }
            }
        }
        let filed: usize = creature.layers.iter().map(|l| l.taps.len()).sum();
        let state = Mutex::new(State {
            hands,
            version: 1,
            tap: filed as u16,
            ..State::default()
        });
        Plugs {
            creature,
            directory,
            inputs,
            outputs,
            state,
            events,
        }
    }

    /// What the creature shows to newcomers, attached layers included.
    pub fn directory(&self) -> Directory {
        let mut directory = self.directory.clone();
        for attached in self.attached() {
            directory.layers.push(attached.plug.layer.clone());
            directory.outputs.extend(attached.plug.outputs.iter().cloned());
        }
        directory
    }

    /// The layers attached now.
    pub fn attached(&self) -> Vec<Attached> {
        self.lock().attached.clone()
    }

    /// Changes whenever a layer comes or goes.
    pub fn version(&self) -> u64 {
        self.lock().version
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
    pub fn attach(&self, plug: Plug, domain: &Domain) -> Result<u32, Vec<String>> {
        let result = self.try_attach(&plug, domain);
        let (layer, pid) = (plug.layer.clone(), plug.pid);
        match &result {
            Ok(_) => self.events.note(
                "layer",
                Some(&layer),
                format!("layer {layer} (pid {pid}) attached"),
            ),
            Err(reasons) => {
                let text = format!("layer {layer} (pid {pid}) refused: {}", reasons.join("; "));
                self.events.note("layer", Some(&layer), text);
            }
        }
        result
    }

    fn try_attach(&self, plug: &Plug, domain: &Domain) -> Result<u32, Vec<String>> {
        let reasons = self.reasons_against(plug);
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
        if state.attached.iter().any(|a| a.plug.layer == plug.layer) {
            return Err(vec![format!("a layer {:?} is attached already", plug.layer)]);
        }
        state.last += 1;
        let number = state.last;
        let mut taps = Vec::new();
        for tap in &plug.taps {
            taps.push(self.join(&mut state, number, plug, tap, &page)?);
        }
        state.attached.push(Attached {
            number,
            plug: plug.clone(),
            page,
            taps,
        });
        state.version += 1;
        Ok(number)
    }

    fn join(
        &self,
        state: &mut State,
        number: u32,
        plug: &Plug,
        tap: &PlugTap,
        page: &Arc<Page>,
    ) -> Result<AttachedTap, Vec<String>> {
        let index = plug
            .outputs
            .iter()
            .position(|o| o.name == tap.from)
            .expect("checked");
        let reader = page.reader(index, plug.outputs[index].kind).expect("checked");
        let gauge = Arc::new(TapGauge::numbered(state.tap_number()));
        let end = TapEnd {
            reader: reader.clone(),
            time_constant: tap.time_constant,
            level: plug.level,
            plug: number,
            gauge: gauge.clone(),
        };
        let (places, command): (_, fn(usize, TapEnd) -> Command) = match tap.how {
            How::Suppress => (&self.inputs, Command::Suppress),
            How::Inhibit => (&self.outputs, Command::Inhibit),
        };
        let (station, port) = places[&tap.to];
        if state.hands[station].commands.push(command(port, end)).is_err() {
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
            gauge,
            reader,
        })
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
        self.events.note("layer", Some(layer), text);
    }

    fn reasons_against(&self, plug: &Plug) -> Vec<String> {
        let mut reasons = Vec::new();
        let outsiders = &self.creature.outsiders;
        let mut against = |wrong: bool, reason: String| {
            if wrong {
                reasons.push(reason);
            }
        };
        let attached = self.attached();
        let taken = self.directory.layers.contains(&plug.layer);
        against(
            taken || attached.iter().any(|a| a.plug.layer == plug.layer),
            format!("there is a layer {:?} already", plug.layer),
        );
        against(
            attached.len() >= outsiders.layers_max,
            format!("{} layers are attached, the most allowed", attached.len()),
        );
        against(
            plug.level > outsiders.level_max,
            format!(
                "level {} is above {}, the highest allowed",
                plug.level, outsiders.level_max
            ),
        );
        against(
            plug.outputs.len() > ipc::wire::WIRES_MAX,
            "too many outputs".into(),
        );
        against(
            plug.layer.len() > 48 || plug.layer.is_empty(),
            "the layer's name is not one".into(),
        );
        for tap in &plug.taps {
            self.reasons_against_tap(plug, tap, &mut against);
        }
        reasons
    }

    fn reasons_against_tap(&self, plug: &Plug, tap: &PlugTap, against: &mut impl FnMut(bool, String)) {
        let to = &tap.to;
        let ports = if tap.how == How::Suppress {
            &self.directory.inputs
        } else {
            &self.directory.outputs
        };
        let target = ports.iter().find(|p| p.name == *to);
        let source = plug.outputs.iter().find(|o| o.name == tap.from);
        let places = if tap.how == How::Suppress {
            &self.inputs
        } else {
            &self.outputs
        };
        against(
            target.is_none() || !places.contains_key(to),
            format!("there is no such port {to} to tap"),
        );
        against(
            source.is_none(),
            format!("{} is not among the layer's outputs", tap.from),
        );
        against(
            !self.directory.open_taps.contains(to),
            format!("the creature does not open {to} to taps from outside"),
        );
        against(
            self.directory.reflexes.contains(to),
            format!("{to} is part of the halt channel"),
        );
        let longest = self.creature.outsiders.time_constant_max;
        against(
            tap.time_constant > longest,
            format!("the time constant {} is above {longest}", tap.time_constant),
        );
        against(
            tap.time_constant == Span::ZERO,
            "a tap needs a time constant".into(),
        );
        let Some(target) = target else { return };
        against(
            target.level.is_none_or(|l| l >= plug.level),
            format!("{to} is not of a level below {}", plug.level),
        );
        let kinds: (Option<Kind>, Kind) = (source.map(|s| s.kind), target.kind);
        let differ = tap.how == How::Suppress && kinds.0.is_some_and(|kind| kind != kinds.1);
        against(
            differ,
            format!("{} does not carry what {to} takes, {}", tap.from, kinds.1),
        );
    }
}
