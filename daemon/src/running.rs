//! A running daemon: the machine's parts on threads of their own, and everything around them.
//!
//! ```text
//!  real-time:   one thread a layer, the motor unit
//!  ordinary:    world (body), keeper (serves wires, cleans), watcher (status, events), control, page
//! ```
//! Must never leave an actuator moving: however it ends, the body is halted first.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::clock::{self, Span};
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::{Directory, output_ports};
use recording::Manifest;
use serde_json::{Value, json};

use crate::body::pace::Pace;
use crate::body::remote::{self, Remote};
use crate::body::{self, World, WorldEnd};
use crate::events::Events;
use crate::executor::{Beating, Refusal, host, plan};
use crate::feeder::{self, Fed, Tended};
use crate::gate::Causes;
use crate::halt::HaltChannel;
use crate::machine::{Apart, Embodied, Machine};
use crate::plugs::Plugs;
use crate::recorder::{self, Recorder};
use crate::status::{Rates, Record, Watched, WatchedTap};
use crate::threads::{Crew, Start};
use crate::timeline::TimeLine;
use crate::watcher::Watcher;

/// What the threads of the daemon share, none of them real-time.
pub struct Shared {
    /// Name of this instance.
    pub name: String,
    /// The creature.
    pub creature: Creature,
    /// The halt channel.
    pub halt: Arc<HaltChannel>,
    /// What happened.
    pub events: Arc<Events>,
    /// Who is attached.
    pub plugs: Plugs,
    /// Shared memory.
    pub domain: Domain,
    /// Where the pace of the world is set, if it takes one.
    pub pace: Option<Arc<Pace>>,
    /// What of the world does not change; known once the body is there.
    floor: Mutex<Value>,
    /// What happens, for those who record it.
    pub recorder: Recorder,
    /// What stood when, for those who look back.
    pub timeline: Mutex<TimeLine>,
    status: Mutex<Arc<Value>>,
}

impl Shared {
    /// The newest status.
    pub fn status(&self) -> Value {
        let status = self
            .status
            .lock()
            .expect("nobody panics holding the status")
            .clone();
        Value::clone(&status)
    }

    /// Another status.
    pub(crate) fn set_status(&self, status: Value) {
        *self.status.lock().expect("nobody panics holding the status") = Arc::new(status);
    }

    /// What of the world does not change.
    pub fn floor(&self) -> Value {
        self.floor
            .lock()
            .expect("nobody panics holding the floor")
            .clone()
    }

    /// Another body was found.
    pub(crate) fn set_floor(&self, floor: Value) {
        *self.floor.lock().expect("nobody panics holding the floor") = floor;
        self.plugs.picture_changed();
    }
}

/// Time for every thread to be ready before the first beat is due.
const START_WAIT: Span = Span::millis(50);

/// A running daemon.
pub struct Running {
    /// What its threads share.
    pub shared: Arc<Shared>,
    /// What the host refused; empty in real time.
    pub refusals: Vec<Refusal>,
    /// What was measured of every layer and the motor unit.
    pub records: Arc<Mutex<Vec<Record>>>,
    beating: Vec<Beating>,
    helpers: Vec<JoinHandle<()>>,
    stop: Arc<AtomicBool>,
    leave: Arc<AtomicBool>,
}

/// Why a creature that does not run in best effort does not run here.
fn refused(refusals: &[Refusal]) -> std::io::Error {
    let lines: Vec<String> = refusals.iter().map(Refusal::to_string).collect();
    let text = format!(
        "the host does not grant real time and [executor] best_effort is \"refuse\":\n  {}",
        lines.join("\n  ")
    );
    std::io::Error::new(std::io::ErrorKind::PermissionDenied, text)
}

/// Starts `machine`, whose wires are in `owned`, as `name`, and records it as `settings` say. `body` is the name of
/// the process that runs its body, if one does; `fed` is who is fed while all is well.
///
/// # Errors
/// When the host refuses a thread, or the file to record into.
pub fn start(
    name: &str,
    machine: Machine,
    owned: OwnedPage,
    domain: Domain,
    settings: &recorder::Settings,
    body: Option<&str>,
    fed: Fed,
) -> std::io::Result<Running> {
    let began = clock::monotonic();
    let events = Arc::new(Events::new(began));
    let Machine {
        creature,
        page,
        stations,
        hands,
        body: embodied,
        apart,
        taps,
        halt,
        watchdog,
    } = machine;
    let directory = Directory::of(&creature, name);
    let floor = embodied.as_ref().map_or(Value::Null, |b| b.world.floor());
    let causes = Causes::named().map(|(_, name)| name.to_string()).collect();
    let manifest = Manifest::of(&creature, name, &settings.file, began, causes);
    let plugs = Plugs::new(creature.clone(), directory, hands, events.clone());
    let shared = Arc::new(Shared {
        name: name.into(),
        creature: creature.clone(),
        halt: halt.clone(),
        events,
        plugs,
        domain,
        pace: embodied.as_ref().and_then(|b| b.world.pace()),
        floor: Mutex::new(floor),
        recorder: Recorder::new(manifest, settings.flight.is_some()),
        timeline: Mutex::default(),
        status: Mutex::new(Arc::new(json!({}))),
    });
    let (stop, leave) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let planned = plan::threads(&creature).map_err(|faults| {
        let text = faults.join("; ");
        std::io::Error::new(std::io::ErrorKind::InvalidInput, text)
    })?;
    let mut crew = Crew::new(Start {
        begin: (clock::monotonic() + START_WAIT).off_tick(),
        halt: halt.clone(),
        stop: stop.clone(),
        policy: creature.executor.policy,
        threads: planned.len(),
    });
    crew.refusals.extend(host::be_ordinary().err());
    crew.refusals.extend(host::lock_memory().err());
    host::limit_runaway();
    host::keep_off(creature.layers.iter().filter_map(|layer| layer.cpu));
    let mut helpers = Vec::new();
    if let Some(path) = &settings.record {
        helpers.push(recorder::listener::into_file(shared.clone(), path)?);
    }
    crew.start_layers(planned, stations)?;
    let view = Arc::new(Mutex::new(json!({})));
    let progress = watchdog.progress.clone();
    if let Some(spec) = &creature.body {
        crew.start_watchdog(watchdog, spec.period)?;
    }
    if let Some(Embodied {
        motor,
        world,
        link,
        gauge,
    }) = embodied
    {
        let period = motor.period();
        crew.start_motor(motor, gauge)?;
        helpers.push(live(world, link, period, view.clone(), leave.clone())?);
    }
    if let (Some(apart), Some(spec), Some(body)) = (apart, &creature.body, body) {
        let Apart {
            motor,
            gauge,
            giver,
            first,
        } = apart;
        crew.start_motor(motor, gauge)?;
        let remote = Remote {
            name: body.into(),
            declaration: spec.declaration,
            first,
            giver,
        };
        helpers.push(remote::keep(remote, shared.clone(), view.clone(), leave.clone())?);
    }
    let Crew {
        beating,
        records,
        feeds,
        mut refusals,
        ..
    } = crew;
    if !creature.executor.best_effort && !refusals.is_empty() {
        stop.store(true, Ordering::Relaxed);
        leave.store(true, Ordering::Relaxed);
        shared.recorder.end();
        beating.into_iter().for_each(Beating::join);
        helpers.into_iter().for_each(|helper| drop(helper.join()));
        return Err(refused(&refusals));
    }
    refusals.dedup();
    let mode = if refusals.is_empty() {
        "real time"
    } else {
        "best effort"
    };
    let tended = Tended {
        progress: creature.body.is_some().then_some(progress),
        beats: records.iter().map(|record| record.gauge.clone()).collect(),
        mode,
    };
    helpers.push(feeder::feed(fed, tended, shared.clone(), leave.clone())?);
    helpers.push(keeper(owned, shared.clone(), leave.clone())?);
    let net = output_ports(&creature)
        .enumerate()
        .map(|(i, (name, port, _))| Watched {
            name: name.to_string(),
            unit: port.unit.into(),
            reader: page
                .reader(i, port.kind)
                .expect("the page has a cell for each output"),
        });
    let net: Vec<Watched> = net.collect();
    let watched_taps = taps.iter().map(|filed| WatchedTap {
        how: filed.tap.how,
        from: filed.tap.from.to_string(),
        to: filed.tap.to.to_string(),
        time_constant: filed.tap.time_constant,
        layer: (layer_of(&creature, &filed.tap), filed.level),
        reader: net
            .iter()
            .find(|w| w.name == filed.tap.from.to_string())
            .expect("checked")
            .reader
            .clone(),
        gauge: filed.gauge.clone(),
        at: None,
        joined: true,
    });
    let records = Arc::new(Mutex::new(records));
    let watcher = Watcher {
        shared: shared.clone(),
        began,
        mode,
        notes: refusals.iter().map(Refusal::to_string).collect(),
        taps: watched_taps.collect(),
        wires: net,
        records: records.clone(),
        view,
        rates: Rates::default(),
        causes: Causes::NONE,
        counts: Vec::new(),
    };
    helpers.push(watcher.watch(leave.clone())?);
    helpers.push(recorder::start(shared.clone(), feeds, settings, leave.clone())?);
    Ok(Running {
        shared,
        refusals,
        records,
        beating,
        helpers,
        stop,
        leave,
    })
}

/// The layer that declares a tap.
fn layer_of(creature: &Creature, tap: &ipc::wiring::creature::Tap) -> String {
    let layer = creature.layers.iter().find(|l| l.taps.contains(tap));
    layer.map_or(String::new(), |l| l.name.clone())
}

impl Running {
    /// Kernel thread ids of the real-time threads, with their names.
    pub fn threads(&self) -> Vec<(String, i32)> {
        self.beating.iter().map(|b| (b.name.clone(), b.tid)).collect()
    }

    /// Halts the body, waits until it stands, and ends the process with a failure: shared memory was cut short
    /// under it, and what iceoryx2 keeps there may be gone as well. The next start removes what remains.
    pub fn leave_cut(&self) -> ! {
        self.shared.halt.halt(Causes::MEMORY);
        let text = "a shared-memory segment was cut short by another process; halting, then leaving";
        self.shared.events.note("halt", None, text);
        self.come_to_a_stand(Causes::MEMORY);
        std::process::exit(1)
    }

    /// Halts the body, waits until it stands, and ends the process the hard way: a thread panicked, and may be held
    /// up in saying so for as long as nobody reads what it says.
    pub fn leave_panicked(&self) -> ! {
        self.come_to_a_stand(Causes::PANIC);
        std::process::abort()
    }

    /// Waits until the gate has closed for `cause` and the body stands.
    fn come_to_a_stand(&self, cause: Causes) {
        // Ten beats of the motor unit at its default period; then its end of the link is stale anyway.
        for _ in 0..20 {
            if self.shared.halt.decided().0.has(cause) {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        // From full speed at the braking of a small robot: 0.3 m/s at 1 m/s².
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Halts the body, waits until it stands, ends every thread.
    pub fn shut_down(mut self) {
        feeder::stopping();
        self.shared.halt.halt(Causes::SHUTDOWN);
        self.come_to_a_stand(Causes::SHUTDOWN);
        self.stop.store(true, Ordering::Relaxed);
        self.beating.drain(..).for_each(Beating::join);
        self.leave.store(true, Ordering::Relaxed);
        for helper in self.helpers.drain(..) {
            let _ = helper.join();
        }
        let Running { shared, .. } = self;
        // Callers may hold it a moment longer; then the next daemon cleans up.
        if let Ok(shared) = Arc::try_unwrap(shared) {
            drop(shared.plugs);
            shared.domain.leave();
        }
    }
}

/// The world lives: ticks in real time on an ordinary thread.
fn live(
    mut world: Box<dyn World>,
    mut link: WorldEnd,
    period: Span,
    view: Arc<Mutex<Value>>,
    leave: Arc<AtomicBool>,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("world".into()).spawn(move || {
        host::come_first();
        let mut due = clock::monotonic();
        while !leave.load(Ordering::Relaxed) {
            let now = clock::monotonic();
            body::turn(world.as_mut(), &mut link, clock::monotonic);
            *view.lock().expect("nobody panics holding the view") = world.view();
            due = due.max(now - period) + period;
            clock::sleep_until(due);
        }
        world.halt();
    })
}

/// Serves the wires to newcomers, drops what layers let go, cleans up after dead processes.
fn keeper(owned: OwnedPage, shared: Arc<Shared>, leave: Arc<AtomicBool>) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("keeper".into()).spawn(move || {
        let mut turns = 0_u32;
        while !leave.load(Ordering::Relaxed) {
            owned.serve();
            shared.plugs.sweep();
            turns = turns.wrapping_add(1);
            if turns.is_multiple_of(400) {
                shared.domain.clean();
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    })
}
