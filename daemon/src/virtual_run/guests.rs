//! Layers that join a run on the virtual clock: asked the same questions and joined by the same commands as
//! in real time, but stepped in the run's own thread on a page of their own.
//!
//! Must never leave a trace but in the taps that run out: a layer that goes takes its page with it.

use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble};
use afsm::layer::{Command, Hand};
use afsm::places::Places;
use afsm::process::plug_request;
use ipc::clock::Time;
use ipc::control::{Plug, PlugTap};
use ipc::wire::{Page, Reader, TapGauge};
use ipc::wiring::creature::{Creature, How, PortName};
use ipc::wiring::directory::{Directory, output_ports};
use ipc::wiring::{Catalog, Rejected, Source, check};

use crate::executor::gauge::BeatGauge;
use crate::machine::{Net, Station};
use crate::policy::{Place, Policy, has_port, settled, tap_end};

/// A manifest as it stands in a file of its own, or in a table of another document.
#[derive(Clone, Debug)]
pub struct Manifest {
    /// The text it stands in.
    pub source: Source,
    /// The table that holds it, with the name of the creature if it says none; `None` for a whole file.
    pub table: Option<(Vec<String>, String)>,
}

impl Manifest {
    /// Checks the manifest against the creature that shows `host`.
    ///
    /// # Errors
    /// Every error in it.
    pub fn check(&self, catalog: &dyn Catalog, host: &Directory) -> Result<Creature, Rejected> {
        match &self.table {
            None => check::manifest(&self.source, catalog, host),
            Some((path, name)) => {
                let path: Vec<&str> = path.iter().map(String::as_str).collect();
                check::inline(&self.source, &path, name, catalog, Some(host))
            }
        }
    }
}

/// A layer that has joined.
pub struct Guest {
    /// Its number: every coming has one of its own.
    pub number: u32,
    /// What it asked for.
    pub plug: Plug,
    /// The layer itself.
    pub station: Station,
    pub(super) page: Arc<Page>,
    pub(super) due: Option<Time>,
    /// Numbers of its wires in the log.
    pub(super) logged: Vec<usize>,
    /// How other guests reach into it.
    pub(super) hand: Hand,
    /// Where its ports are.
    places: Places,
    /// Where its own taps are counted, in the order of what it asked for.
    gauges: Vec<Arc<TapGauge>>,
}

/// A tap as a run knows it, also after its layer has gone.
#[derive(Clone, Debug)]
pub(super) struct KnownTap {
    pub(super) how: How,
    pub(super) from: String,
    pub(super) to: String,
    pub(super) gauge: Arc<TapGauge>,
    /// Where it is joined.
    pub(super) place: Spot,
}

/// Where a tap is joined.
#[derive(Clone, Debug)]
pub(super) enum Spot {
    /// At a port of the creature.
    Own(Place),
    /// At the n-th register or outlet of the guest called so, whenever it is here.
    Guest(String, usize),
    /// At the n-th command of the body.
    Body(usize),
}

/// What a newcomer reads: its own wires, the creature's, and those of the other guests.
struct Neighbours<'n> {
    own: Net,
    creature: Net,
    guests: &'n [Guest],
}

impl Wires for Neighbours<'_> {
    fn reader(&self, output: &PortName) -> Option<Reader> {
        let found = self.own.reader(output).or_else(|| self.creature.reader(output));
        found.or_else(|| self.guests.iter().find_map(|g| g.reader(&output.to_string())))
    }
}

impl Guest {
    fn reader(&self, name: &str) -> Option<Reader> {
        let index = self.plug.outputs.iter().position(|o| o.name == name)?;
        self.page.reader(index, self.plug.outputs[index].kind)
    }
}

/// What a run knows of its guests.
pub(super) struct Guests {
    pub(super) policy: Policy,
    pub(super) kinds: Kinds,
    pub(super) here: Vec<Guest>,
    pub(super) taps: Vec<KnownTap>,
    last: u32,
}

impl Guests {
    pub(super) fn new(creature: &Creature, kinds: Kinds, taps: &[FiledTap]) -> Guests {
        let policy = Policy::new(creature.clone(), Directory::of(creature, &creature.name));
        let known = |filed: &FiledTap| {
            let (from, to) = (filed.tap.from.to_string(), filed.tap.to.to_string());
            let place = match filed.tap.how {
                How::Suppress => policy.input(&to),
                How::Inhibit => policy.output(&to),
            };
            let command = || {
                let body = creature.body.as_ref().expect("checked");
                let input = body.declaration.input(&filed.tap.to.port);
                input.expect("checked").0
            };
            KnownTap {
                how: filed.tap.how,
                from,
                to,
                gauge: filed.gauge.clone(),
                place: place.map_or_else(|| Spot::Body(command()), Spot::Own),
            }
        };
        let taps = taps.iter().map(known).collect();
        Guests {
            policy,
            kinds,
            here: Vec::new(),
            taps,
            last: 0,
        }
    }

    /// Lets the layer of `manifest` in at `now`; its first beat comes its phase later.
    pub(super) fn plug(
        &mut self,
        manifest: &Manifest,
        now: Time,
        creature: (&Creature, &Arc<Page>),
        hands: &mut [Hand],
    ) -> Result<usize, Vec<String>> {
        let directory = self.policy.directory_with(self.present());
        let checked = manifest.check(&self.kinds, &directory);
        let checked = checked.map_err(|rejected| {
            let told = rejected.located().into_iter();
            told.map(|l| format!("{}; {}", l.message, l.help))
                .collect::<Vec<_>>()
        })?;
        let [layer] = checked.layers.as_slice() else {
            return Err(vec!["a layer process runs one [[layer]]".into()]);
        };
        let owner = format!("{}/{}", creature.0.name, layer.name);
        let plug = settled(plug_request(&checked, layer, &owner, &directory, 0));
        let reasons = self.policy.reasons_against(&plug, self.present());
        if !reasons.is_empty() {
            return Err(reasons);
        }
        self.last += 1;
        let page = Page::in_memory(output_ports(&checked).count());
        let neighbours = Neighbours {
            own: Net::new(&checked, &page),
            creature: Net::new(creature.0, creature.1),
            guests: &self.here,
        };
        let (running, hand) = assemble(layer, &self.kinds, &page, 0, &neighbours, &[], creature.0.seed);
        let station = Station {
            spec: layer.clone(),
            running,
            gauge: Arc::new(BeatGauge::default()),
        };
        let guest = Guest {
            number: self.last,
            places: Places::of(layer),
            gauges: plug.taps.iter().map(|_| Arc::default()).collect(),
            due: Some(now + station.spec.phase),
            plug,
            station,
            page,
            logged: Vec::new(),
            hand,
        };
        self.welcome(guest, hands);
        Ok(self.here.len() - 1)
    }

    /// The layers that are here, as the policy asks for them.
    fn present(&self) -> impl Iterator<Item = (u32, &Plug)> {
        self.here.iter().map(|g| (g.number, &g.plug))
    }

    /// Joins the taps of a newcomer, and those of others that waited for it; whoever reads its wires is connected
    /// to them.
    fn welcome(&mut self, newcomer: Guest, hands: &mut [Hand]) {
        for (tap, gauge) in newcomer.plug.taps.iter().zip(&newcomer.gauges) {
            let end = tap_end(
                newcomer.number,
                &newcomer.plug,
                tap,
                &newcomer.page,
                gauge.clone(),
            );
            let place = match self.policy.place(tap.how, &tap.to) {
                Some((station, port)) => {
                    give(&mut hands[station], Command::join(tap.how, port, end));
                    Spot::Own((station, port))
                }
                None => {
                    let owner = self
                        .here
                        .iter_mut()
                        .find(|g| has_port(&g.plug, tap))
                        .expect("checked");
                    let port = owner.places.tapped(tap.how, &tap.to).expect("checked");
                    give(&mut owner.hand, Command::join(tap.how, port, end));
                    Spot::Guest(owner.plug.layer.clone(), port)
                }
            };
            self.taps.push(KnownTap {
                how: tap.how,
                from: tap.from.clone(),
                to: tap.to.clone(),
                gauge: gauge.clone(),
                place,
            });
        }
        self.here.push(newcomer);
        let Some((newcomer, others)) = self.here.split_last_mut() else {
            return;
        };
        for other in others {
            let present = (newcomer.number, &newcomer.plug);
            let waiting = |tap: &PlugTap| {
                has_port(&newcomer.plug, tap)
                    && self
                        .policy
                        .reasons_against_rejoining(&other.plug, tap, present)
                        .is_empty()
            };
            for (tap, gauge) in other.plug.taps.iter().zip(&other.gauges) {
                if waiting(tap) {
                    let end = tap_end(other.number, &other.plug, tap, &other.page, gauge.clone());
                    let port = newcomer.places.tapped(tap.how, &tap.to).expect("it has the port");
                    give(&mut newcomer.hand, Command::join(tap.how, port, end));
                }
            }
            for (from, to) in &other.plug.wires {
                if let (Some(wire), Some(input)) = (newcomer.reader(from), other.places.input(to)) {
                    give(&mut other.hand, Command::Connect(input, wire));
                }
            }
        }
    }

    /// Lets the layer called `name` go: nothing is written any more, its taps are told to go. Says whether it
    /// was there.
    pub(super) fn leave(&mut self, name: &str, hands: &mut [Hand]) -> bool {
        let Some(index) = self.here.iter().position(|g| g.plug.layer == name) else {
            return false;
        };
        let guest = self.here.remove(index);
        let others = self.here.iter_mut().map(|g| &mut g.hand);
        for hand in hands.iter_mut().chain(others) {
            give(hand, Command::Release(guest.number));
        }
        true
    }
}

fn give(hand: &mut Hand, command: Command) {
    assert!(
        hand.commands.push(command).is_ok(),
        "every command is taken up at once"
    );
}
