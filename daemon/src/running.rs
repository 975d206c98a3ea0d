//! A running daemon: the machine's parts on threads of their own, and everything around them.
//!
//! ```text
//!  real-time:   one thread a layer, the motor unit
//!  ordinary:    world (body), keeper (serves wires, cleans), watcher (status, events), control, page
//! ```
//! Must never leave an actuator moving: however it ends, the body is halted first.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use afsm::layer::RunningLayer;
use afsm::trace::{self, Trace, Tracer};
use ipc::clock::{self, Span, Time};
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wiring::creature::{Creature, Overrun};
use ipc::wiring::directory::{Directory, output_ports};
use recording::Manifest;
use serde_json::{Value, json};

use crate::alloc;
use crate::body::{World, WorldEnd};
use crate::events::Events;
use crate::executor::{self, Beating, Beats, Plan, host, host::Refusal};
use crate::gate::Causes;
use crate::machine::{Embodied, Machine};
use crate::motor::{HaltChannel, Motor};
use crate::plugs::Plugs;
use crate::recorder::{self, Feed, Recorder};
use crate::status::{self, Rates, Record, Watched, WatchedTap};

/// Priority of the motor unit; layers come below it, the shorter the period the higher. Above what ordinary
/// programs choose, below the kernel's own threads at 99.
const PRIORITY_MAX: u8 = 80;

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
    /// What of the world does not change.
    pub floor: Value,
    /// What happens, for those who record it.
    pub recorder: Recorder,
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
}

/// A running daemon.
pub struct Running {
    /// What its threads share.
    pub shared: Arc<Shared>,
    /// What the host refused; empty in real time.
    pub refusals: Vec<Refusal>,
    beating: Vec<Beating>,
    helpers: Vec<JoinHandle<()>>,
    stop: Arc<AtomicBool>,
    leave: Arc<AtomicBool>,
}

struct LayerBeats(RunningLayer);

impl Beats for LayerBeats {
    fn beat(&mut self, now: Time) {
        self.0.step(now);
        self.0.commit(clock::monotonic());
    }
}

struct MotorBeats(Motor);

impl Beats for MotorBeats {
    fn beat(&mut self, now: Time) {
        self.0.gather(now);
        self.0.act(clock::monotonic());
    }
}

/// Starts `machine`, whose wires are in `owned`, as `name`, and records it as `settings` say.
///
/// # Errors
/// When the host refuses a thread, or the file to record into.
pub fn start(
    name: &str,
    machine: Machine,
    owned: OwnedPage,
    domain: Domain,
    settings: &recorder::Settings,
) -> std::io::Result<Running> {
    let began = clock::monotonic();
    let events = Arc::new(Events::new(began));
    let Machine {
        creature,
        page,
        stations,
        hands,
        body,
        taps,
        halt,
    } = machine;
    let directory = Directory::of(&creature, name);
    let floor = body.as_ref().map_or(Value::Null, |b| b.world.floor());
    let causes = Causes::all().map(|(_, name)| name.to_string()).collect();
    let manifest = Manifest::of(&creature, name, &settings.file, began, causes);
    let plugs = Plugs::new(creature.clone(), directory, hands, events.clone());
    let shared = Arc::new(Shared {
        name: name.into(),
        creature: creature.clone(),
        halt: halt.clone(),
        events,
        plugs,
        domain,
        floor,
        recorder: Recorder::new(manifest, settings.flight.is_some()),
        status: Mutex::new(Arc::new(json!({}))),
    });
    let (stop, leave) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    let mut refusals: Vec<Refusal> = host::lock_memory().err().into_iter().collect();
    host::limit_runaway();
    // Time for every thread to be ready before the first beat is due.
    let begin = clock::monotonic() + Span::millis(50);
    let mut beating = Vec::new();
    let mut records = Vec::new();
    let mut helpers = Vec::new();
    let mut feeds = Vec::new();
    if let Some(path) = &settings.record {
        helpers.push(recorder::listener::into_file(shared.clone(), path)?);
    }
    let mut periods: Vec<Span> = stations.iter().map(|s| s.spec.period).collect();
    periods.sort();
    periods.dedup();
    for mut station in stations {
        let (tracer, trace) = traced(station.spec.period, station.running.ports());
        station.running.trace(tracer);
        feeds.push(Feed::new(trace, station.gauge.clone()));
        let spec = &station.spec;
        let rank = periods.iter().position(|p| *p == spec.period).unwrap_or(0);
        let monotonic = PRIORITY_MAX.saturating_sub(1 + rank as u8).max(1);
        let plan = Plan {
            name: spec.name.clone(),
            period: spec.period,
            phase: spec.phase,
            priority: Some(spec.priority.unwrap_or(monotonic)),
            cpu: spec.cpu,
            overrun: spec.overrun,
        };
        let (name, level, period) = (spec.name.clone(), spec.level, spec.period);
        let gauge = station.gauge.clone();
        let thread = executor::start(
            plan,
            begin,
            LayerBeats(station.running),
            gauge.clone(),
            halt.clone(),
            stop.clone(),
        )?;
        keep(
            &mut beating,
            &mut records,
            &mut refusals,
            thread,
            (&name, Some(level), period, gauge),
        );
    }
    let view = Arc::new(Mutex::new(json!({})));
    if let Some(Embodied {
        mut motor,
        world,
        link,
        gauge,
    }) = body
    {
        let period = motor.period();
        let (tracer, trace) = traced(period, motor.ports());
        motor.trace(tracer);
        feeds.push(Feed::new(trace, gauge.clone()));
        let plan = Plan {
            name: "motor".into(),
            period,
            phase: Span::ZERO,
            priority: Some(PRIORITY_MAX),
            cpu: None,
            overrun: Overrun::Skip,
        };
        let thread = executor::start(
            plan,
            begin,
            MotorBeats(motor),
            gauge.clone(),
            halt.clone(),
            stop.clone(),
        )?;
        keep(
            &mut beating,
            &mut records,
            &mut refusals,
            thread,
            ("motor", None, period, gauge),
        );
        helpers.push(live(world, link, period, view.clone(), leave.clone())?);
    }
    refusals.dedup();
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
    });
    let watcher = Watcher {
        shared: shared.clone(),
        began,
        mode: if refusals.is_empty() {
            "real time"
        } else {
            "best effort"
        },
        notes: refusals.iter().map(Refusal::to_string).collect(),
        taps: watched_taps.collect(),
        wires: net,
        records,
        view,
        rates: Rates::default(),
        causes: Causes::NONE,
    };
    helpers.push(watcher.watch(leave.clone())?);
    helpers.push(recorder::start(shared.clone(), feeds, settings, leave.clone())?);
    Ok(Running {
        shared,
        refusals,
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

fn traced(period: Span, (registers, outlets): (usize, usize)) -> (Tracer, Trace) {
    trace::trace(period, registers, outlets)
}

fn keep(
    beating: &mut Vec<Beating>,
    records: &mut Vec<Record>,
    refusals: &mut Vec<Refusal>,
    mut thread: Beating,
    (name, level, period, gauge): (&str, Option<u8>, Span, Arc<executor::gauge::BeatGauge>),
) {
    for refusal in std::mem::take(&mut thread.refusals) {
        if !refusals.iter().any(|r| r.grants == refusal.grants) {
            refusals.push(refusal);
        }
    }
    let (_, empty) = rtrb::RingBuffer::new(1);
    let samples = std::mem::replace(&mut thread.samples, empty);
    records.push(Record::new(name, level, period, gauge, samples));
    beating.push(thread);
}

impl Running {
    /// Kernel thread ids of the real-time threads, with their names.
    pub fn threads(&self) -> Vec<(String, i32)> {
        self.beating.iter().map(|b| (b.name.clone(), b.tid)).collect()
    }

    /// Halts the body, waits until it stands, ends every thread.
    pub fn shut_down(mut self) {
        self.shared.halt.halt(Causes::SHUTDOWN);
        // Ten beats of the motor unit at its default period; then its end of the link is stale anyway.
        for _ in 0..20 {
            if self.shared.halt.decided().0.has(Causes::SHUTDOWN) {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        // From full speed at the braking of a small robot: 0.3 m/s at 1 m/s².
        std::thread::sleep(Duration::from_millis(300));
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
        let mut due = clock::monotonic();
        while !leave.load(Ordering::Relaxed) {
            let now = clock::monotonic();
            world.tick(now, &mut link);
            *view.lock().expect("nobody panics holding the view") = world.view();
            due = due.max(now - period) + period;
            clock::sleep_until(due);
        }
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

/// Looks at everything ten times a second.
struct Watcher {
    shared: Arc<Shared>,
    began: Time,
    mode: &'static str,
    notes: Vec<String>,
    wires: Vec<Watched>,
    taps: Vec<WatchedTap>,
    records: Vec<Record>,
    view: Arc<Mutex<Value>>,
    rates: Rates,
    causes: Causes,
}

impl Watcher {
    fn watch(mut self, leave: Arc<AtomicBool>) -> std::io::Result<JoinHandle<()>> {
        std::thread::Builder::new().name("watcher".into()).spawn(move || {
            while !leave.load(Ordering::Relaxed) {
                self.look();
                std::thread::sleep(Duration::from_millis(100));
            }
        })
    }

    fn look(&mut self) {
        let now = clock::monotonic();
        for record in &mut self.records {
            let new = record.drain();
            if new > 0 {
                let text = format!(
                    "{} ran over its period {new} times (of {} beats)",
                    record.name,
                    record.gauge.counts().beats
                );
                self.shared.events.note("overrun", Some(&record.name), text);
            }
        }
        self.note_halts();
        let status = self.status(now);
        *self
            .shared
            .status
            .lock()
            .expect("nobody panics holding the status") = Arc::new(status);
    }

    /// Notes when the body halts and goes on; a reflex is everyday life and not noted.
    fn note_halts(&mut self) {
        let causes = self.shared.halt.decided().0.without(Causes::REFLEX);
        if causes == self.causes {
            return;
        }
        let text = match causes {
            Causes::NONE => "the body may move".to_string(),
            some => format!("the body is halted: {}", some.names().join(", ")),
        };
        self.causes = causes;
        self.shared.events.note("halt", None, text);
    }

    fn status(&mut self, now: Time) -> Value {
        let attached = self.shared.plugs.attached();
        let mut wires: Vec<Value> = self
            .wires
            .iter()
            .map(|w| status::wire(w, &mut self.rates, now))
            .collect();
        let mut taps: Vec<Value> = self.taps.iter().map(|t| status::tap(t, now)).collect();
        let mut layers = status::layers(&self.records);
        for a in &attached {
            layers.push(status::attached(a));
            for (index, output) in a.plug.outputs.iter().enumerate() {
                let Some(reader) = a.page.reader(index, output.kind) else {
                    continue;
                };
                let watched = Watched {
                    name: output.name.clone(),
                    unit: output.unit.clone(),
                    reader,
                };
                wires.push(status::wire(&watched, &mut self.rates, now));
            }
            for t in &a.taps {
                let watched = WatchedTap {
                    how: t.tap.how,
                    from: t.tap.from.clone(),
                    to: t.tap.to.clone(),
                    time_constant: t.tap.time_constant,
                    layer: (a.plug.layer.clone(), a.plug.level),
                    reader: t.reader.clone(),
                    gauge: t.gauge.clone(),
                };
                taps.push(status::tap(&watched, now));
            }
        }
        let (causes, since) = self.shared.halt.decided();
        let events = self.shared.events.after(0);
        let newest: Vec<_> = events.iter().rev().take(50).rev().collect();
        let mut status = json!({
            "creature": self.shared.name, "pid": std::process::id(),
            "time_s": now.since(self.began).seconds(), "graph_version": self.shared.plugs.version(),
            "mode": self.mode, "notes": self.notes,
            "halt": {
                "halted": causes != Causes::NONE, "causes": causes.names(),
                "since_s": since.since(self.began).seconds(), "latched": causes.has(Causes::LATCHED),
            },
            "halts": self.shared.halt.counts().collect::<BTreeMap<_, _>>(),
            "wires": wires, "taps": taps, "layers": layers, "events": newest,
            "real_time_allocations": alloc::broken(),
        });
        let view = self.view.lock().expect("nobody panics holding the view").clone();
        if let (Some(status), Value::Object(view)) = (status.as_object_mut(), view) {
            status.extend(view);
        }
        status
    }
}
