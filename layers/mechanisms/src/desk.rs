//! The desk: where commands to a hierarchy that beats in this process come in.
//!
//! ```text
//!   socket ─► desk: program, list, undo (an ordinary thread) ─ new hierarchy ─► seat in the beating module
//!                                                           ◄─ the one before ─
//! ```
//! A hierarchy changes hands between two evaluations, whole or not at all. What it replaces comes back over the
//! other ring and is let go here: the beating thread neither allocates nor frees.
//!
//! Must never be served by a thread that beats.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use adroit::hierarchy::{Hierarchy, MechanismIndex};
use adroit::language::Running;
use adroit::live::Listener;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::programs::{BuiltIn, built_in};

/// Hierarchies under way: each is awaited before the next one is sent, so one would do.
const UNDER_WAY_MAX: usize = 2;
/// How often the desk looks whether somebody asks.
const LOOK: Duration = Duration::from_millis(20);
/// How often it looks whether a hierarchy was taken up, and how many times: two seconds in all.
const TAKEN: (Duration, u32) = (Duration::from_millis(5), 400);

/// A new hierarchy, with the places of its RMs in the one before.
struct Succession {
    hierarchy: Hierarchy,
    places: Box<[Option<MechanismIndex>]>,
}

/// The desk's ends of the rings to a seat.
struct Hand {
    give: Producer<Succession>,
    take: Consumer<Succession>,
    /// What sits there, or will when it has taken up all that is under way.
    seated: Hierarchy,
}

struct Desk {
    running: Running,
    hand: Option<Hand>,
}

/// The desk of this process, if it has one: a process runs one hierarchy that takes commands.
static DESK: Mutex<Option<Desk>> = Mutex::new(None);

/// Its revision, beside the lock: the desk is held for as long as a command waits to be taken up.
static REVISION: AtomicU64 = AtomicU64::new(0);

/// How often the hierarchy of the desk has changed; zero where there is no desk. Waits for nobody.
#[must_use]
pub fn revision() -> u64 {
    REVISION.load(Ordering::Relaxed)
}

/// What is to be seen of the desk's hierarchy, if this process has a desk.
pub(crate) fn looked_at<T>(look: impl FnOnce(&Running) -> T) -> Option<T> {
    let desk = DESK.lock().unwrap_or_else(PoisonError::into_inner);
    desk.as_ref().map(|desk| look(&desk.running))
}

/// Where a hierarchy sits in a beating module.
pub(crate) struct Seat {
    pub(crate) hierarchy: Hierarchy,
    ends: Option<(Consumer<Succession>, Producer<Succession>)>,
}

/// The desk while it is served; when this is dropped nobody is answered any more, and the socket is gone.
#[must_use]
#[derive(Debug)]
pub struct Served {
    leave: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Opens the desk of this process with a program; every module built from now on runs it. With a socket,
/// commands are served from an ordinary thread.
///
/// # Errors
/// In words, when the socket cannot be opened.
pub fn open(running: Running, socket: Option<&Path>) -> Result<Served, String> {
    let listener = socket.map(Listener::open).transpose()?;
    *DESK.lock().unwrap_or_else(PoisonError::into_inner) = Some(Desk { running, hand: None });
    let leave = Arc::new(AtomicBool::new(false));
    let thread = listener.map(|listener| {
        let leave = leave.clone();
        std::thread::spawn(move || {
            while !leave.load(Ordering::Relaxed) {
                attend(&listener);
                std::thread::sleep(LOOK);
            }
        })
    });
    Ok(Served { leave, thread })
}

/// Answers those who ask now.
fn attend(listener: &Listener) {
    if let Some(Desk { running, hand }) = &mut *DESK.lock().unwrap_or_else(PoisonError::into_inner) {
        listener.serve(running, |running| hand_over(running, hand.as_mut()));
        REVISION.store(running.revision(), Ordering::Relaxed);
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.leave.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic there was told where it happened.
            let _ = thread.join();
        }
    }
}

/// Opens the desk for the one hierarchy among modules of these kinds, with its built-in program; see [`open`].
///
/// # Errors
/// In words, when there is none or more than one, or when the socket cannot be opened.
pub fn open_for<'a>(kinds: impl Iterator<Item = &'a str>, socket: &Path) -> Result<Served, String> {
    let built_in: Vec<_> = kinds.filter_map(built_in).collect();
    let [program] = &built_in[..] else {
        let found = built_in.len();
        return Err(format!(
            "expected one module of kind mechanisms.nest or mechanisms.drives to command; the creature has {found}"
        ));
    };
    open(program.running(), Some(socket))
}

/// A seat with the hierarchy of the desk, or with what `built_in` gives where there is none. Called before the
/// module beats.
pub(crate) fn seat(built_in: &BuiltIn) -> Seat {
    let mut desk = DESK.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(desk) = desk.as_mut() else {
        return Seat {
            hierarchy: built_in.running().hierarchy().clone(),
            ends: None,
        };
    };
    let (give, news) = RingBuffer::new(UNDER_WAY_MAX);
    let (old, take) = RingBuffer::new(UNDER_WAY_MAX);
    let hierarchy = desk.running.hierarchy().clone();
    desk.hand = Some(Hand {
        give,
        take,
        seated: hierarchy.clone(),
    });
    Seat {
        hierarchy,
        ends: Some((news, old)),
    }
}

/// Hands the desk's hierarchy to the seat and waits until it sits there; what sat there tells what it did.
fn hand_over(running: &mut Running, hand: Option<&mut Hand>) {
    let Some(hand) = hand else { return };
    // The layer may be between two comings, and its seat gone: the next one starts from the desk's hierarchy.
    if hand.give.is_abandoned() {
        return;
    }
    let hierarchy = running.hierarchy().clone();
    let places = hierarchy.places_in(&hand.seated);
    let sent = hierarchy.clone();
    while hand.take.pop().is_ok() {}
    if hand.give.push(Succession { hierarchy, places }).is_err() {
        return;
    }
    hand.seated = sent;
    let (pause, times) = TAKEN;
    for _ in 0..times {
        if let Ok(before) = hand.take.pop() {
            running.hierarchy_mut().carry_over(&before.hierarchy);
            return;
        }
        std::thread::sleep(pause);
    }
}

impl Seat {
    /// Takes up what was handed over since, if anything was. To be called between two evaluations.
    pub(crate) fn take_up(&mut self) {
        let Some((news, old)) = &mut self.ends else { return };
        while !old.is_full()
            && let Ok(mut next) = news.pop()
        {
            next.hierarchy.carry_over_at(&self.hierarchy, &next.places);
            std::mem::swap(&mut next.hierarchy, &mut self.hierarchy);
            // There is room: nobody else writes this ring.
            let _ = old.push(next);
        }
    }
}
