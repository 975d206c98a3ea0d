//! The recorder: takes what the beating threads traced, and everything else that happens, to whoever records.
//!
//! ```text
//!   real-time threads ─► traces ─┐                      ┌─► ring (the last minute) ─► a file when the body halts
//!   wires of attached layers ────┼─► recorder's thread ─┼─► listener: `subsumectl record`, over its socket
//!   events, overruns ────────────┘                      └─► listener: `subsumed --record FILE`
//! ```
//! Must never make a beating thread wait: traces are fetched, never asked for, and a listener that is slow loses
//! items, which shows as gaps in the numbers of beats and messages.

pub mod flight;
pub mod listener;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use afsm::trace::Trace;
use ipc::clock::{self, Span, Time};
use ipc::wire::Reader;
use recording::{Item, Manifest, Plugged, Ring};

use crate::executor::gauge::{BeatCounts, BeatGauge};
use crate::executor::host;
use crate::gate::Causes;
use crate::plugs::Attached;
use crate::running::Shared;
use flight::Flight;

/// How long the flight recorder remembers.
pub const FLIGHT_SPAN: Span = Span::secs(60);

/// Most memory that items waiting for a listener take: seconds of a hundred wires at 1 kHz.
const LISTENER_BYTES_MAX: usize = 16 << 20;

/// How often traces are fetched; they hold half a second.
const FETCH: Duration = Duration::from_millis(10);

/// How often the wires of attached layers are looked at: layers at up to 500 Hz lose nothing.
const LOOK: Duration = Duration::from_millis(1);

/// Causes of a halt after which the flight recorder keeps what it holds: not start, reflex and shutdown, which
/// are everyday life. Until the creature has started, none counts: its body and commands are still to come.
pub const KEPT: Causes = Causes::STALE
    .with(Causes::UNSOUND)
    .with(Causes::VITAL)
    .with(Causes::OVERRUN)
    .with(Causes::EMERGENCY)
    .with(Causes::BODY)
    .with(Causes::WATCHDOG)
    .with(Causes::MEMORY)
    .with(Causes::PANIC);

/// What is to be recorded without anybody asking.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The creature file's text.
    pub file: String,
    /// Where the flight recorder keeps its files; none to keep none.
    pub flight: Option<PathBuf>,
    /// Where everything is recorded from the first beat on.
    pub record: Option<PathBuf>,
}

/// What a listener gets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// What every source holds now.
    Now,
    /// What the ring holds.
    Past,
}

/// The recorder, as others see it.
pub struct Recorder {
    /// What recordings say of the creature.
    pub manifest: Arc<Manifest>,
    state: Mutex<State>,
}

struct State {
    ring: Ring,
    listeners: Vec<Listener>,
    /// Nobody will speak any more.
    over: bool,
}

/// The recorder's end of what a listener hears.
struct Listener {
    items: Sender<Item>,
    /// Bytes that wait; counted up here, down by the listener.
    waiting: Arc<AtomicUsize>,
}

impl Listener {
    /// Tells it an item, unless too many wait: then it loses the item, and the numbers show it. False if it is gone.
    fn tell(&self, item: &Item) -> bool {
        // Relaxed: a bound that is off by an item is still a bound.
        if self.waiting.load(Ordering::Relaxed) > LISTENER_BYTES_MAX {
            return Arc::strong_count(&self.waiting) > 1;
        }
        self.waiting.fetch_add(item.bytes(), Ordering::Relaxed);
        self.items.send(item.clone()).is_ok()
    }
}

/// A listener's end.
pub struct Heard {
    items: Receiver<Item>,
    waiting: Arc<AtomicUsize>,
}

impl Heard {
    /// The next item, if one comes in time.
    ///
    /// # Errors
    /// When none does, or none ever will.
    pub fn next(&self, wait: Duration) -> Result<Item, RecvTimeoutError> {
        let item = self.items.recv_timeout(wait)?;
        self.waiting.fetch_sub(item.bytes(), Ordering::Relaxed);
        Ok(item)
    }
}

/// What one beating thread has to tell.
pub struct Feed {
    trace: Trace,
    gauge: Arc<BeatGauge>,
    counts: BeatCounts,
    lost: u64,
}

impl Feed {
    /// Of the thread that traces into `trace` and counts in `gauge`.
    pub fn new(trace: Trace, gauge: Arc<BeatGauge>) -> Feed {
        Feed {
            trace,
            gauge,
            counts: BeatCounts::default(),
            lost: 0,
        }
    }
}

impl Recorder {
    /// A recorder of the creature that `manifest` describes; remembers for [`FLIGHT_SPAN`] if it is to fly.
    pub fn new(manifest: Manifest, flies: bool) -> Recorder {
        let span = if flies { FLIGHT_SPAN } else { Span::ZERO };
        let ring = Ring::new(&manifest, span, ring_bytes());
        Recorder {
            manifest: Arc::new(manifest),
            state: Mutex::new(State {
                ring,
                listeners: Vec::new(),
                over: false,
            }),
        }
    }

    /// Listens from now on: what comes first, and then every item as it happens.
    pub fn listen(&self, begin: Begin) -> (Vec<Item>, Heard) {
        let (sender, items) = channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let mut state = self.lock();
        let ring = state.ring.clone();
        if !state.over {
            state.listeners.push(Listener {
                items: sender,
                waiting: waiting.clone(),
            });
        }
        // Going through it takes a while; the recorder must not wait for that.
        drop(state);
        let first = match begin {
            Begin::Now => ring.state(),
            Begin::Past => ring.snapshot(),
        };
        (first, Heard { items, waiting })
    }

    /// Nobody speaks any more: whoever listens, now or later, ends.
    pub(crate) fn end(&self) {
        let mut state = self.lock();
        state.over = true;
        state.listeners.clear();
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().expect("nobody panics holding the recorder")
    }

    fn tell(&self, items: &[Item]) {
        let mut state = self.lock();
        for item in items {
            state.ring.push(item.clone());
        }
        state
            .listeners
            .retain(|listener| items.iter().all(|item| listener.tell(item)));
    }
}

/// How much memory a ring may take: where locked memory is limited, a part of that, so that the daemon's own is safe.
fn ring_bytes() -> usize {
    let spare = host::lockable_bytes().map_or(u64::MAX, |limit| limit / 8);
    recording::ring::RING_BYTES_MAX.min(usize::try_from(spare).unwrap_or(usize::MAX))
}

/// Starts the recorder's thread.
///
/// # Errors
/// When the host refuses it.
pub fn start(
    shared: Arc<Shared>,
    feeds: Vec<Feed>,
    settings: &Settings,
    leave: Arc<AtomicBool>,
) -> std::io::Result<JoinHandle<()>> {
    let fetcher = Fetcher {
        flight: settings.flight.clone().map(Flight::new),
        shared,
        feeds,
        events: 0,
        version: 0,
        attached: Vec::new(),
        halts: 0,
        standing: Causes::START,
    };
    std::thread::Builder::new()
        .name("recorder".into())
        .spawn(move || fetcher.run(&leave))
}

/// The recorder's thread.
struct Fetcher {
    shared: Arc<Shared>,
    feeds: Vec<Feed>,
    flight: Option<Flight>,
    events: u64,
    version: u64,
    attached: Vec<Watched>,
    halts: u64,
    /// What the gate was closed for at the last look.
    standing: Causes,
}

/// An attached layer whose wires are looked at.
struct Watched {
    number: u32,
    wires: Vec<(Reader, u64)>,
}

impl Fetcher {
    fn run(mut self, leave: &AtomicBool) {
        while !leave.load(Ordering::Relaxed) {
            self.turn();
            std::thread::sleep(if self.attached.is_empty() { FETCH } else { LOOK });
        }
        self.turn();
        if let Some(flight) = &mut self.flight {
            flight.wait();
        }
        // Recordings end when their listeners find nobody speaking.
        self.shared.recorder.end();
    }

    fn turn(&mut self) {
        let now = clock::monotonic();
        let mut items = self.fetch_traces(now);
        self.fetch_plugs(now, &mut items);
        self.fetch_events(&mut items);
        items.sort_by_key(Item::time);
        self.shared.recorder.tell(&items);
        let Some(flight) = &mut self.flight else { return };
        let counts = self.shared.halt.counts();
        let kept = counts.iter().filter(|counted| KEPT.has(counted.cause));
        let halts: u64 = kept.map(|counted| counted.count).sum();
        let standing = self.shared.halt.decided().0;
        let starting = standing.with(std::mem::replace(&mut self.standing, standing));
        if halts != std::mem::replace(&mut self.halts, halts) && !starting.has(Causes::START) {
            flight.halted(now, Causes(standing.0 & KEPT.0));
        }
        flight.turn(now, &self.shared, || self.shared.recorder.lock().ring.snapshot());
    }

    fn fetch_traces(&mut self, now: Time) -> Vec<Item> {
        let mut items = Vec::new();
        for (source, feed) in self.feeds.iter_mut().enumerate() {
            let source = source as u16;
            items.extend(
                std::iter::from_fn(|| feed.trace.next_beat()).map(|words| Item::Beat { source, words }),
            );
            let counts = feed.gauge.counts();
            if counts.overruns != feed.counts.overruns {
                items.push(Item::Overrun {
                    source,
                    time: now,
                    overruns: counts.overruns,
                    skipped: counts.skipped,
                });
            }
            feed.counts = counts;
            let lost = feed.trace.lost();
            if lost != feed.lost {
                items.push(Item::Lost {
                    source,
                    time: now,
                    beats: lost,
                });
            }
            feed.lost = lost;
        }
        items
    }

    fn fetch_plugs(&mut self, now: Time, items: &mut Vec<Item>) {
        let version = self.shared.plugs.version();
        if version != self.version {
            self.version = version;
            let attached = self.shared.plugs.attached();
            for watched in &self.attached {
                if attached.iter().all(|a| a.number != watched.number) {
                    items.push(Item::Unplugged(now, watched.number));
                }
            }
            self.attached
                .retain(|w| attached.iter().any(|a| a.number == w.number));
            for layer in &attached {
                if self.attached.iter().all(|w| w.number != layer.number) {
                    items.push(Item::Plugged(now, Arc::new(plugged(layer))));
                    self.attached.push(watch(layer));
                }
            }
        }
        for layer in &mut self.attached {
            for (index, (reader, seen)) in layer.wires.iter_mut().enumerate() {
                let Some(reading) = reader.newer_than(*seen) else {
                    continue;
                };
                *seen = reading.number;
                items.push(Item::Wire {
                    plug: layer.number,
                    index,
                    kind: reader.kind(),
                    reading: Box::new(reading),
                });
            }
        }
    }

    fn fetch_events(&mut self, items: &mut Vec<Item>) {
        for event in self.shared.events.after(self.events) {
            self.events = event.number;
            let since = Span::from_seconds(event.time_s).unwrap_or(Span::ZERO);
            let time = Time(self.shared.recorder.manifest.began_ns) + since;
            items.push(Item::Log(time, Arc::new(event)));
        }
    }
}

fn watch(layer: &Attached) -> Watched {
    let outputs = layer.plug.outputs.iter().enumerate();
    Watched {
        number: layer.number,
        wires: outputs
            .filter_map(|(index, output)| Some((layer.page.reader(index, output.kind)?, 0)))
            .collect(),
    }
}

/// An attached layer as recordings show it.
fn plugged(layer: &Attached) -> Plugged {
    Plugged {
        number: layer.number,
        plug: layer.plug.clone(),
        taps: layer.taps.iter().map(|t| t.gauge.number()).collect(),
    }
}
