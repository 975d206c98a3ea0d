//! A body in a process of its own: what the `main` of a simulation's or a hardware driver's process calls.
//!
//! ```text
//!   own the page of sensors ─► listen at <run>/NAME.body ─► turn, turn, turn …     (from the first moment on)
//!                                   │ a daemon says hello: map its commands, hand them to the turning thread
//!                                   │ it goes: halted at once; the next one may come
//!   SIGTERM ─► gate closed ─► turns until it stands ─► World::halt ─► leave
//! ```
//! It starts halted, and is halted whenever the daemon is dead, frozen or hangs: commands go stale by the
//! body's own clock (see [`gate`](super::gate)). It outlives daemons; it never looks for one.
//!
//! The turning thread runs under SCHED_FIFO where the host grants it. Unlike the daemon's it is not sealed: a
//! driver does its device's I/O there, which must be bounded, and must keep to its period.
//!
//! Must never let anything but the turning thread reach the world, nor that thread wait for a daemon.

use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use ipc::body::{PULSE_KIND, Pulse, body_socket, owner_of};
use ipc::clock::{self, Span, Time};
use ipc::control::run_dir;
use ipc::wire::Page;
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wiring::creature::{Overrun, Wake};
use rtrb::{Consumer, Producer, RingBuffer};
use serde_json::Value;

use super::handover::Giver;
use super::link::{CommandReaders, command_readers, world_cells, world_end};
use super::{BodyKind, World, WorldEnd, turn};
use crate::executor::{self, Beats, Plan, Schedule, host};
use crate::gate::Causes;
use crate::panicked;
use crate::segment;

mod house;

/// Priority of the turning thread: below the daemon's motor unit and watchdog, above its layers of 2 ms and
/// slower.
const PRIORITY: u8 = 77;

/// Most connections at once: one daemon, and some that are refused.
const CALLERS_MAX: usize = 8;

/// How long a caller may take to say hello.
const HELLO_WAIT: Duration = Duration::from_secs(2);

/// How long a leaving body turns on with its gate closed, to come to a stand: from full speed at the braking
/// of a small robot, 0.3 m/s at 1 m/s².
const STANDSTILL: Duration = Duration::from_millis(300);

/// What a body process runs.
pub struct Body {
    /// The name by which a daemon finds it: 1 to 48 letters, digits, '-' or '_'.
    pub name: String,
    /// Its kind: what a creature file names.
    pub kind: &'static BodyKind,
    /// Time between two turns.
    pub period: Span,
    /// What it turns.
    pub world: Box<dyn World>,
    /// Leave after so long; none to stay until a signal comes.
    pub limit: Option<Duration>,
}

/// Runs a body process to its end: what its `main` calls. Status: 0 after a signal or the limit, 1 when the
/// host refuses or shared memory was cut.
pub fn main(body: Body) -> ExitCode {
    let name = body.name.clone();
    match run(body) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("body {name}: {message}");
            ExitCode::FAILURE
        }
    }
}

/// What the ordinary threads share.
struct House {
    name: String,
    kind: &'static BodyKind,
    period: Span,
    domain: Domain,
    floor: Value,
    /// The creature whose daemon drives.
    driver: Mutex<Option<String>>,
    giver: Mutex<Giver<CommandReaders>>,
    views: Mutex<Views>,
    view_wanted: Arc<AtomicBool>,
    leave: AtomicBool,
    callers: AtomicUsize,
}

/// How the world looks, as the turning thread tells it. What it made goes back to it: whoever else freed that would
/// hold the lock of its memory, perhaps for long on a busy host.
struct Views {
    told: Consumer<Value>,
    spent: Producer<Value>,
}

impl Views {
    /// The newest, as a copy.
    fn take(&mut self) -> Option<Value> {
        let told = self.told.pop().ok()?;
        let copy = told.clone();
        let _room = self.spent.push(told);
        Some(copy)
    }
}

/// The world, as the turning thread has it.
struct Turning {
    world: Box<dyn World>,
    link: WorldEnd,
    view_wanted: Arc<AtomicBool>,
    views: Producer<Value>,
    spent: Consumer<Value>,
    leaving: Arc<AtomicBool>,
}

impl Beats for Turning {
    fn beat(&mut self, _: Time) {
        if self.leaving.load(Ordering::Relaxed) {
            self.link.close(Causes::SHUTDOWN);
        }
        if segment::cut() > 0 {
            self.link.close(Causes::MEMORY);
        }
        if panicked::any() {
            self.link.close(Causes::PANIC);
        }
        turn(self.world.as_mut(), &mut self.link, clock::monotonic);
        while self.spent.pop().is_ok() {}
        if self.view_wanted.swap(false, Ordering::Relaxed) {
            // Nobody takes it any more: then nobody misses it.
            let _ = self.views.push(self.world.view());
        }
    }
}

impl Drop for Turning {
    fn drop(&mut self) {
        self.world.halt();
    }
}

fn run(body: Body) -> Result<(), String> {
    let Body {
        name,
        kind,
        period,
        world,
        limit,
    } = body;
    let signalled = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, signalled.clone())
            .map_err(|e| format!("signal {signal}: {e}"))?;
    }
    if UnixStream::connect(body_socket(&name)).is_ok() {
        return Err("a process runs a body of this name already; stop it, or choose another --name".into());
    }
    panicked::guard();
    segment::guard().map_err(|e| format!("a handler for SIGBUS: {e}"))?;
    let domain = Domain::join(&owner_of(&name)).map_err(|e| e.to_string())?;
    let owned = domain
        .own(&owner_of(&name), world_cells(kind.declaration))
        .map_err(|e| e.to_string())?;
    let page = owned.page().clone();
    let (link, giver) = world_end(kind, &page);
    let (view_in, view_out) = RingBuffer::new(1);
    // One for each that a turn may tell, and one that came too late.
    let (spent_in, spent_out) = RingBuffer::new(2);
    let leaving = Arc::new(AtomicBool::new(false));
    let house = Arc::new(House {
        name: name.clone(),
        kind,
        period,
        domain,
        floor: world.floor(),
        driver: Mutex::new(None),
        giver: Mutex::new(giver),
        views: Mutex::new(Views {
            told: view_out,
            spent: spent_in,
        }),
        view_wanted: Arc::new(AtomicBool::new(false)),
        leave: AtomicBool::new(false),
        callers: AtomicUsize::new(0),
    });
    let turning = Turning {
        world,
        link,
        view_wanted: house.view_wanted.clone(),
        views: view_in,
        spent: spent_out,
        leaving: leaving.clone(),
    };
    let listener = listen(&name).map_err(|e| format!("its socket: {e}"))?;
    let refusal = host::lock_memory().err();
    host::limit_runaway();
    let stop = Arc::new(AtomicBool::new(false));
    let thread = start(turning, period, stop.clone()).map_err(|e| format!("starting its thread: {e}"))?;
    for refusal in refusal.iter().chain(&thread.refusals) {
        eprintln!("body {name}: BEST EFFORT: {refusal}");
    }
    let keeper = keep(owned, house.clone()).map_err(|e| format!("starting a thread: {e}"))?;
    let caller = accept(listener, house.clone()).map_err(|e| format!("starting a thread: {e}"))?;
    eprintln!(
        "body {name}: kind {}, halted, waits for a daemon",
        kind.declaration.name
    );
    watch(&name, &page, &signalled, limit);
    leaving.store(true, Ordering::Relaxed);
    std::thread::sleep(STANDSTILL);
    if panicked::any() {
        // Whoever panicked may be held up in saying so for as long as nobody reads it.
        std::process::abort();
    }
    stop.store(true, Ordering::Relaxed);
    thread.join();
    let _ = std::fs::remove_file(body_socket(&name));
    if segment::cut() > 0 {
        // What iceoryx2 keeps in that memory may be gone as well: nothing is tidied up from here.
        return Err("a shared-memory segment was cut short by another process; halted, and left".into());
    }
    house.leave.store(true, Ordering::Relaxed);
    let _ = keeper.join();
    let _ = caller.join();
    let _ = std::fs::remove_dir(run_dir());
    drop(page);
    // A caller may hold it a moment longer; then the next process cleans up.
    if let Ok(house) = Arc::try_unwrap(house) {
        drop(house.giver);
        house.domain.leave();
    }
    Ok(())
}

fn start(turning: Turning, period: Span, stop: Arc<AtomicBool>) -> io::Result<executor::Beating> {
    let plan = Plan {
        name: "body".into(),
        period,
        phase: Span::ZERO,
        schedule: Schedule::Fifo(PRIORITY),
        cpu: None,
        wake: Wake::Sleep,
        overrun: Overrun::Skip,
        sealed: false,
    };
    let begin = clock::monotonic().off_tick();
    executor::start(plan, begin, turning, Vec::new(), Arc::default(), stop)
}

/// Says when the gate closes and opens, until it is time to leave.
fn watch(name: &str, page: &Arc<Page>, signalled: &AtomicBool, limit: Option<Duration>) {
    let began = Instant::now();
    let pulse = page
        .reader(page.len() - 1, PULSE_KIND)
        .expect("the last cell is the pulse");
    let mut seen = Causes::START;
    while !signalled.load(Ordering::Relaxed)
        && limit.is_none_or(|limit| began.elapsed() < limit)
        && segment::cut() == 0
        && !panicked::any()
    {
        if let Some(reading) = pulse.read() {
            let causes = Causes(u64::from(Pulse::unpack(&reading.words).causes));
            if causes != seen {
                let stamp = reading.stamp.seconds();
                match causes {
                    Causes::NONE => eprintln!("body {name}: free to move ({stamp:.3} s)"),
                    some => eprintln!("body {name}: halted: {} ({stamp:.3} s)", some.names().join(", ")),
                }
                seen = causes;
            }
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn listen(name: &str) -> io::Result<UnixListener> {
    let path = body_socket(name);
    std::fs::create_dir_all(run_dir())?;
    // Of a dead process: a living one would have answered.
    let _ = std::fs::remove_file(&path);
    let listener = UnixListener::bind(&path)?;
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Serves the page of sensors, and cleans up after dead daemons.
fn keep(owned: OwnedPage, house: Arc<House>) -> io::Result<std::thread::JoinHandle<()>> {
    std::thread::Builder::new().name("keeper".into()).spawn(move || {
        let mut turns = 0_u32;
        while !house.leave.load(Ordering::Relaxed) {
            owned.serve();
            turns = turns.wrapping_add(1);
            if turns.is_multiple_of(400) {
                house.domain.clean();
            }
            if let Ok(mut giver) = house.giver.try_lock() {
                giver.sweep();
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    })
}

fn accept(listener: UnixListener, house: Arc<House>) -> io::Result<std::thread::JoinHandle<()>> {
    std::thread::Builder::new().name("callers".into()).spawn(move || {
        while !house.leave.load(Ordering::Relaxed) {
            let Ok((stream, _)) = listener.accept() else {
                std::thread::sleep(Duration::from_millis(10));
                continue;
            };
            if house.callers.load(Ordering::Relaxed) >= CALLERS_MAX {
                continue;
            }
            house.callers.fetch_add(1, Ordering::Relaxed);
            let at = house.clone();
            let spawned = std::thread::Builder::new()
                .name("caller".into())
                .stack_size(512 << 10)
                .spawn(move || {
                    let _ = at.receive(stream);
                    at.callers.fetch_sub(1, Ordering::Relaxed);
                });
            if spawned.is_err() {
                house.callers.fetch_sub(1, Ordering::Relaxed);
            }
        }
    })
}
