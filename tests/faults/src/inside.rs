//! The daemon with a module on trial: all of the daemon's own parts, and one more layer that breaks on SIGUSR1.
//!
//! ```text
//!   sound ──SIGUSR1──► broken: loops for ever │ panics │ overruns once      (says when, on standard error)
//! ```
//! Must never be part of the daemon that is shipped: the module's kind exists here alone.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use afsm::kind::{ModuleKind, Settings};
use afsm::module::{Beat, Module};
use clap::ValueEnum;
use daemon::admission::Admission;
use daemon::control::{self, Control};
use daemon::executor::host;
use daemon::feeder::Fed;
use daemon::machine::{Machine, cells_apart, kinds};
use daemon::running;
use ipc::clock::{self, Span, Time};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::{Declaration, Port, Source, check};

use crate::trial::{BODY, CREATURE};

/// How long an overrun lasts: two and a half periods of its layer.
const OVERRUN: Span = Span::millis(25);

/// How long each step of a busy module takes: so that a signal comes in mid-step more often than not.
const BUSY: Span = Span::millis(6);

/// Time between two beats of the layer on trial, as it is written in its file.
pub(crate) const PERIOD: Span = Span::millis(10);

/// How the module breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Break {
    /// It does not, but takes most of its period.
    Busy,
    /// It never comes back; its layer is vital.
    Loop,
    /// It panics.
    Panic,
    /// It overruns once; its layer halts on that.
    Overrun,
    /// It overruns once; its layer skips beats on that.
    Skip,
}

impl Break {
    /// Its name on a command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Break::Busy => "busy",
            Break::Loop => "loop",
            Break::Panic => "panic",
            Break::Overrun => "overrun",
            Break::Skip => "skip",
        }
    }

    fn settings(self) -> &'static str {
        match self {
            Break::Loop => "vital = true",
            Break::Overrun => "overrun = \"halt\"",
            _ => "overrun = \"skip\"",
        }
    }
}

/// Set by SIGUSR1, taken by the module.
static BROKEN: AtomicBool = AtomicBool::new(false);

/// When the module broke, in nanoseconds; 0 before.
static BROKE: AtomicU64 = AtomicU64::new(0);

static DECLARATION: Declaration = Declaration {
    name: "tried.break",
    about: "breaks when told so",
    diagram: "",
    inputs: &[],
    outputs: &[Port::new("out", Kind::Pulse, "never written")],
    parameters: &[],
};

const fn kind(build: fn(&Settings<'_>) -> Box<dyn Module>) -> ModuleKind {
    ModuleKind {
        declaration: &DECLARATION,
        build,
    }
}

static BUSY_KIND: ModuleKind = kind(|_: &Settings<'_>| Box::new(Tried(Break::Busy)));
static LOOP_KIND: ModuleKind = kind(|_: &Settings<'_>| Box::new(Tried(Break::Loop)));
static PANIC_KIND: ModuleKind = kind(|_: &Settings<'_>| Box::new(Tried(Break::Panic)));
static OVERRUN_KIND: ModuleKind = kind(|_: &Settings<'_>| Box::new(Tried(Break::Overrun)));
static SKIP_KIND: ModuleKind = kind(|_: &Settings<'_>| Box::new(Tried(Break::Skip)));

fn kind_of(how: Break) -> &'static ModuleKind {
    match how {
        Break::Busy => &BUSY_KIND,
        Break::Loop => &LOOP_KIND,
        Break::Panic => &PANIC_KIND,
        Break::Overrun => &OVERRUN_KIND,
        Break::Skip => &SKIP_KIND,
    }
}

struct Tried(Break);

impl Module for Tried {
    fn step(&mut self, _: &mut Beat<'_>) {
        if self.0 == Break::Busy {
            spin(BUSY);
        }
        if !BROKEN.swap(false, Ordering::Relaxed) {
            return;
        }
        let now = clock::monotonic();
        BROKE.store(now.0, Ordering::Relaxed);
        match self.0 {
            Break::Busy => {}
            // The kernel ends the process after half a second of this: see `limit_runaway`.
            Break::Loop => loop {
                std::hint::spin_loop();
            },
            Break::Panic => {
                eprintln!("fault {}", now.0);
                panic!("as told");
            }
            Break::Overrun | Break::Skip => spin(OVERRUN),
        }
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "on trial"
    }
}

/// Spins for `span`, which is bounded by the clock.
fn spin(span: Span) {
    let end = clock::monotonic() + span;
    while clock::monotonic() < end {
        std::hint::spin_loop();
    }
}

/// Runs Allen with one more layer, whose module breaks `how` on SIGUSR1, until SIGTERM or for `seconds`. Its
/// body is a process of its own.
///
/// # Errors
/// What the host refuses.
pub(crate) fn run(how: Break, seconds: f64) -> Result<(), String> {
    daemon::alloc::share_one_heap();
    let (leave, said) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    for (signal, flag) in [
        (signal_hook::consts::SIGTERM, &leave),
        (signal_hook::consts::SIGUSR1, &said),
    ] {
        signal_hook::flag::register(signal, flag.clone()).map_err(|e| format!("signal {signal}: {e}"))?;
    }
    let _ = host::be_ordinary();
    daemon::panicked::guard();
    let text = format!(
        "{}\n[[layer]]\nname = \"trial\"\nlevel = 1\nperiod = \"{PERIOD}\"\n{}\n[layer.modules]\n\
         tried = {{ kind = \"tried.break\" }}\n",
        allen::CREATURE,
        how.settings()
    );
    let kinds = kinds().with([kind_of(how)]);
    let mut creature = check::creature(&Source::new("trial", text), &kinds).map_err(|e| e.to_string())?;
    creature.name = CREATURE.into();
    control::claim(CREATURE).map_err(|e| e.to_string())?;
    let domain = Domain::join(CREATURE).map_err(|e| e.to_string())?;
    let cells = cells_apart(&creature);
    let owned = domain.own(CREATURE, cells).map_err(|e| e.to_string())?;
    let admission = Admission::of(&creature.outsiders)?;
    let machine = Machine::apart(creature, &kinds, owned.page().clone());
    let settings = daemon::recorder::Settings::default();
    let running = running::start(
        CREATURE,
        machine,
        owned,
        domain,
        &settings,
        Some(BODY),
        Fed::default(),
    );
    let running = running.map_err(|e| format!("starting threads: {e}"))?;
    let control = Control::open(CREATURE, running.shared.clone(), admission);
    let control = control.map_err(|e| format!("the control socket: {e}"))?;
    let over = clock::monotonic() + Span::from_seconds(seconds).unwrap_or(Span::ZERO);
    let mut teller = Teller::default();
    let mut left = false;
    // After the order to leave as well, until what came of it is told.
    while clock::monotonic() < over && !(left && teller.told("shutdown")) {
        if said.swap(false, Ordering::Relaxed) {
            BROKEN.store(true, Ordering::Relaxed);
        }
        if leave.load(Ordering::Relaxed) && !left {
            left = true;
            running.shared.halt.halt(daemon::gate::Causes::SHUTDOWN);
        }
        teller.tell(&running.shared.halt);
        if daemon::panicked::any() && teller.told("panic") {
            running.leave_panicked();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    drop(control);
    running.shut_down();
    Ok(())
}

/// Says a line at once: a thread that panics keeps standard error to itself until all of its message is written, and
/// may be in the middle of a line.
fn say(line: &str) {
    let _ = rustix::io::write(rustix::stdio::stderr(), format!("\n{line}\n").as_bytes());
}

/// Says on standard error when the module broke, and when each cause of a halt began.
#[derive(Debug, Default)]
struct Teller {
    broke: u64,
    told: Vec<(&'static str, Time)>,
}

impl Teller {
    /// Whether it has told of a halt for that cause.
    fn told(&self, cause: &str) -> bool {
        self.told.iter().any(|(told, _)| *told == cause)
    }

    fn tell(&mut self, halt: &daemon::halt::HaltChannel) {
        let broke = BROKE.load(Ordering::Relaxed);
        if broke != self.broke {
            self.broke = broke;
            say(&format!("fault {broke}"));
        }
        for counted in halt.counts() {
            let name = counted.cause.names().first().copied().unwrap_or("");
            if self.told.contains(&(name, counted.began)) {
                continue;
            }
            self.told.retain(|(told, _)| *told != name);
            self.told.push((name, counted.began));
            say(&format!("halt {name}: {}", counted.began.0));
        }
    }
}
