//! Layers that join a run on the virtual clock: asked the same questions and joined by the same commands as
//! in real time, but stepped in the run's own thread on a page of their own.
//!
//! Must never leave a trace but in the taps that run out: a layer that goes takes its page with it.

use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::{FiledTap, Wires, assemble};
use afsm::layer::{Command, Hand};
use afsm::process::plug_request;
use ipc::clock::{Span, Time};
use ipc::control::Plug;
use ipc::wire::{Page, Reader, TapGauge};
use ipc::wiring::creature::{Creature, How, PortName};
use ipc::wiring::directory::{Directory, Listed, output_ports};
use ipc::wiring::{Catalog, Rejected, Source, check};

use crate::executor::gauge::BeatGauge;
use crate::machine::{Net, Station};
use crate::policy::{Place, Policy};

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
    /// Nobody taps a guest from outside; the hand is kept so that its layer's channel stays open.
    pub(super) _hand: Hand,
}

/// A tap as a run knows it, also after its layer has gone.
#[derive(Clone, Debug)]
pub(super) struct KnownTap {
    pub(super) how: How,
    pub(super) from: String,
    pub(super) to: String,
    pub(super) gauge: Arc<TapGauge>,
    /// Where it is joined; `None` for the n-th command of the body.
    pub(super) place: Result<Place, usize>,
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
                place: place.ok_or_else(command),
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
        let directory = self.policy.directory_with(self.here.iter().map(|g| &g.plug));
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
        let outputs: Vec<Listed> = Directory::of(&checked, &owner).outputs;
        let plug = plug_request(layer, &owner, outputs, 0);
        let reasons = self
            .policy
            .reasons_against(&plug, self.here.iter().map(|g| &g.plug));
        if !reasons.is_empty() {
            return Err(reasons);
        }
        self.last += 1;
        let number = self.last;
        let page = Page::in_memory(output_ports(&checked).count());
        let neighbours = Neighbours {
            own: Net::new(&checked, &page),
            creature: Net::new(creature.0, creature.1),
            guests: &self.here,
        };
        let (running, hand) = assemble(layer, &self.kinds, &page, 0, &neighbours, &[], creature.0.seed);
        for tap in &plug.taps {
            let joining = self.policy.join(number, &plug, tap, &page, Arc::default());
            let taken = hands[joining.station].commands.push(joining.command);
            assert!(taken.is_ok(), "every command is taken up at once");
            let place = match tap.how {
                How::Suppress => self.policy.input(&tap.to),
                How::Inhibit => self.policy.output(&tap.to),
            };
            self.taps.push(KnownTap {
                how: tap.how,
                from: tap.from.clone(),
                to: tap.to.clone(),
                gauge: joining.gauge,
                place: Ok(place.expect("checked")),
            });
        }
        let station = Station {
            spec: layer.clone(),
            running,
            gauge: Arc::new(BeatGauge::default()),
        };
        self.here.push(Guest {
            number,
            plug,
            due: Some(now + station.spec.phase),
            station,
            page,
            logged: Vec::new(),
            _hand: hand,
        });
        Ok(self.here.len() - 1)
    }

    /// Lets the layer called `name` go: nothing is written any more, its taps are told to go. Says whether it
    /// was there.
    pub(super) fn leave(&mut self, name: &str, hands: &mut [Hand]) -> bool {
        let Some(index) = self.here.iter().position(|g| g.plug.layer == name) else {
            return false;
        };
        let guest = self.here.remove(index);
        for hand in hands {
            let taken = hand.commands.push(Command::Release(guest.number));
            assert!(taken.is_ok(), "every command is taken up at once");
        }
        true
    }
}

/// The first beat of the grid through `first` that is not before `now`.
pub(super) fn beat_from(first: Time, period: Span, now: Time) -> Time {
    let missed = now.since(first).0.div_ceil(period.0);
    first + Span(missed * period.0)
}
