//! A session: one coming of a layer process, from its manifest to its last beat.
//!
//! Must never share a wire before the manifest was checked, nor beat before the daemon let it in.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::clock::{self, Span};
use ipc::control::{self, Connection, Plug, PlugModule, PlugTap, Reply, Request};
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wire::{Page, Reader};
use ipc::wiring::creature::{Creature, Layer, Module, PortName, Tap};
use ipc::wiring::directory::{Directory, Listed, output_ports};
use ipc::wiring::{Port, Source, check};

use super::attendant::Attendant;
use super::{Trouble, program};
use crate::assemble::{FiledTap, Wires, assemble};
use crate::kind::Kinds;
use crate::layer::{Hand, RunningLayer};

/// How often newcomers to this layer's wires are served.
const SERVE: Duration = Duration::from_millis(5);

/// An attached layer.
pub(super) struct Session {
    pub(super) layer: String,
    period: Span,
    running: RunningLayer,
    gone: Arc<AtomicBool>,
    helpers: Vec<JoinHandle<()>>,
}

impl Session {
    /// Beats until told to leave or the daemon is gone.
    pub(super) fn beat(mut self, leave: &AtomicBool) {
        let mut next = clock::monotonic();
        while !leave.load(Ordering::Relaxed) && !self.gone.load(Ordering::Relaxed) {
            self.running.step(clock::monotonic());
            self.running.commit(clock::monotonic());
            next = (next + self.period).on_grid(self.period, clock::monotonic());
            clock::sleep_until(next);
        }
        end(&self.gone, self.helpers.drain(..));
    }
}

/// Tells the helpers to end, and waits for it.
fn end(gone: &AtomicBool, helpers: impl IntoIterator<Item = JoinHandle<()>>) {
    gone.store(true, Ordering::Relaxed);
    helpers.into_iter().for_each(|helper| drop(helper.join()));
}

/// The wires a layer process can read: its own and those of the processes it mapped.
struct Neighbours {
    creature: Creature,
    own: Arc<Page>,
    directory: Directory,
    pages: HashMap<String, Arc<Page>>,
}

impl Wires for Neighbours {
    fn reader(&self, output: &PortName) -> Option<Reader> {
        let own = output_ports(&self.creature);
        if let Some((index, (_, port, _))) = own.enumerate().find(|(_, (name, ..))| name == output) {
            return self.own.reader(index, port.kind);
        }
        let listed = self
            .directory
            .outputs
            .iter()
            .find(|l| l.name == output.to_string())?;
        self.pages.get(&listed.owner)?.reader(listed.index, listed.kind)
    }
}

/// Joins the creature called `creature_name` with the layer of `manifest`.
pub(super) fn attach(manifest: &Source, kinds: &Kinds, creature_name: &str) -> Result<Session, Trouble> {
    let mut connection = control::call(creature_name, &program()).map_err(Trouble::Call)?;
    let directory = match connection.ask(&Request::Directory).map_err(Trouble::Host)? {
        Reply::Directory(directory) => directory,
        other => return Err(Trouble::Refused(vec![format!("unexpected answer {other:?}")])),
    };
    let creature = check::manifest(manifest, kinds, &directory).map_err(Trouble::Manifest)?;
    let [layer] = creature.layers.as_slice() else {
        return Err(Trouble::Refused(vec![
            "a layer process runs one [[layer]]".into(),
        ]));
    };
    let layer = layer.clone();
    let domain = Arc::new(Domain::join(&layer.name).map_err(Trouble::Share)?);
    let owner = format!("{creature_name}/{}", layer.name);
    let plug = plug_request(&creature, &layer, &owner, &directory, std::process::id());
    let owned = domain.own(&owner, plug.outputs.len()).map_err(Trouble::Share)?;
    let page = owned.page().clone();
    let pages = map_neighbours(&layer, &directory, &domain)?;
    let gone = Arc::new(AtomicBool::new(false));
    // From now on newcomers, the daemon first of all, get this layer's page.
    let keeper = keep(owned, domain.clone(), gone.clone());
    let neighbours = Neighbours {
        creature,
        own: page.clone(),
        directory,
        pages,
    };
    let seed = u64::from(std::process::id()) ^ clock::monotonic().0;
    let none: &[FiledTap] = &[];
    let (running, hand) = assemble(&layer, kinds, &page, 0, &neighbours, none, seed);
    let open = plug.open_taps.clone();
    match join(connection, plug) {
        Ok(connection) => {
            let attendant = attend(connection, domain, hand, &layer, open, gone.clone())?;
            Ok(Session {
                layer: layer.name,
                period: layer.period,
                running,
                gone,
                helpers: vec![attendant, keeper],
            })
        }
        Err(trouble) => {
            end(&gone, [keeper]);
            Err(trouble)
        }
    }
}

/// The pages of all processes whose wires `layer` reads.
fn map_neighbours(
    layer: &Layer,
    directory: &Directory,
    domain: &Domain,
) -> Result<HashMap<String, Arc<Page>>, Trouble> {
    let mut pages = HashMap::new();
    for wire in &layer.wires {
        let Some(listed) = directory.outputs.iter().find(|l| l.name == wire.from.to_string()) else {
            continue;
        };
        if !pages.contains_key(&listed.owner) {
            let page = domain.map(&listed.owner).map_err(Trouble::Share)?;
            pages.insert(listed.owner.clone(), page);
        }
    }
    Ok(pages)
}

/// Asks to be let in.
fn join(mut connection: Connection, plug: Plug) -> Result<Connection, Trouble> {
    match connection.ask(&Request::Plug(plug)) {
        Ok(Reply::Plugged { .. }) => Ok(connection),
        Ok(Reply::Refused { reasons }) => Err(Trouble::Refused(reasons)),
        Ok(other) => Err(Trouble::Refused(vec![format!("unexpected answer {other:?}")])),
        Err(e) => Err(Trouble::Host(e)),
    }
}

/// Serves the layer's wires until it is `gone`.
fn keep(owned: OwnedPage, domain: Arc<Domain>, gone: Arc<AtomicBool>) -> JoinHandle<()> {
    std::thread::spawn(move || {
        while !gone.load(Ordering::Relaxed) {
            owned.serve();
            std::thread::sleep(SERVE);
        }
        drop((owned, domain));
    })
}

/// Does what the daemon says until the layer is `gone`, and tells when the daemon is.
fn attend(
    connection: Connection,
    domain: Arc<Domain>,
    hand: Hand,
    layer: &Layer,
    open: Vec<String>,
    gone: Arc<AtomicBool>,
) -> Result<JoinHandle<()>, Trouble> {
    let attendant = Attendant::new(connection, domain, hand, layer, open).map_err(Trouble::Host)?;
    Ok(std::thread::spawn(move || attendant.serve(&gone)))
}

/// What `layer`, the one of the manifest `creature`, asks of the creature that shows `host`. It shares its wires
/// as `owner`, from process `pid`.
pub fn plug_request(creature: &Creature, layer: &Layer, owner: &str, host: &Directory, pid: u32) -> Plug {
    let names = |ports: &[Port]| ports.iter().map(|p| p.name.to_string()).collect();
    let module = |m: &Module| PlugModule {
        name: m.name.clone(),
        kind: m.declaration.name.into(),
        inputs: names(m.declaration.inputs),
        outputs: names(m.declaration.outputs),
    };
    let tap = |t: &Tap| PlugTap {
        how: t.how,
        from: t.from.to_string(),
        to: t.to.to_string(),
        time_constant: t.time_constant,
    };
    let own = Directory::of(creature, owner);
    let reads = |l: &&Listed| l.plug != 0 && layer.wires.iter().any(|w| w.from.to_string() == l.name);
    let mut neighbours: Vec<u32> = host.outputs.iter().filter(reads).map(|l| l.plug).collect();
    neighbours.dedup();
    Plug {
        layer: layer.name.clone(),
        level: layer.level,
        period: layer.period,
        pid,
        owner: owner.into(),
        outputs: own.outputs,
        inputs: own.inputs,
        open_taps: own.open_taps,
        open_reads: own.open_reads,
        neighbours,
        modules: layer.modules.iter().map(module).collect(),
        wires: layer
            .wires
            .iter()
            .map(|w| (w.from.to_string(), w.to.to_string()))
            .collect(),
        taps: layer.taps.iter().map(tap).collect(),
    }
}
