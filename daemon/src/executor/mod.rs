//! The executor: fixed-period threads that beat.
//!
//! ```text
//!   sleep until due ─► look at the clock ─► step ─► commit ─► count ─► next due (policy if late)
//! ```
//! Must never do anything on a beating thread, once it is sealed, but this: no allocation, no lock, no page
//! fault, no system call other than the sleep.

pub mod deadline;
pub mod gauge;
pub mod host;
pub mod plan;
mod refused;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use ipc::clock::{self, Span, Time};
use ipc::wiring::creature::Wake;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::alloc;
use crate::gate::Causes;
use crate::halt::HaltChannel;
use deadline::Pace;
use gauge::{BeatGauge, SAMPLES_MAX, Sample};
pub use host::Refusal;
pub use plan::{Plan, Schedule};

/// Something that beats: one or more members that step together.
pub trait Beats: Send + 'static {
    /// One beat, due now.
    fn beat(&mut self, now: Time);

    /// How long member `k` took in the last beat, where there are several; the whole beat if not known.
    fn took(&self, _member: usize) -> Option<Span> {
        None
    }
}

/// Where the time comes from and how it is waited for; the host's clock, but for tests.
trait Timing {
    fn now(&mut self) -> Time;
    fn wait(&mut self, due: Time, wake: Wake);
}

/// The host's monotonic clock.
struct Host;

impl Timing for Host {
    fn now(&mut self) -> Time {
        clock::monotonic()
    }

    /// Waits until `due`. Spinning is bounded by its lead: the clock runs on.
    fn wait(&mut self, due: Time, wake: Wake) {
        match wake {
            Wake::Sleep => clock::sleep_until(due),
            Wake::Spin(lead) => {
                clock::sleep_until(due - lead);
                while clock::monotonic() < due {
                    std::hint::spin_loop();
                }
            }
        }
    }
}

/// What one member of a thread shows: its counters, and where its samples go.
struct Face {
    gauge: Arc<BeatGauge>,
    samples: Producer<Sample>,
}

/// A thread that beats.
#[derive(Debug)]
pub struct Beating {
    /// Its name.
    pub name: String,
    /// Samples of its members' beats, to be drained by a watcher.
    pub samples: Vec<Consumer<Sample>>,
    /// Its kernel thread id.
    pub tid: i32,
    /// What the host refused it.
    pub refusals: Vec<Refusal>,
    thread: JoinHandle<()>,
}

impl Beating {
    /// Waits for the thread to end.
    pub fn join(self) {
        let _ = self.thread.join();
    }
}

/// Stack of a beating thread; locked memory, so not more than a step of any layer needs.
const STACK_BYTES: usize = 512 << 10;

/// How much of it is touched before the first beat.
const TOUCHED_BYTES: usize = 256 << 10;

/// Starts a thread that beats until `stop`, with one of `gauges` for each member of `beats`. Its first beat is
/// the first of its grid after `begin`.
///
/// # Errors
/// When the host refuses the thread itself.
pub fn start(
    plan: Plan,
    begin: Time,
    mut beats: impl Beats,
    gauges: Vec<Arc<BeatGauge>>,
    halt: Arc<HaltChannel>,
    stop: Arc<AtomicBool>,
) -> std::io::Result<Beating> {
    let (mut faces, samples): (Vec<Face>, Vec<Consumer<Sample>>) = gauges.into_iter().map(face).unzip();
    let (ready_in, ready) = std::sync::mpsc::channel();
    let name = plan.name.clone();
    let thread = std::thread::Builder::new()
        .name(name.clone())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            let tid = rustix::thread::gettid().as_raw_nonzero().get();
            let _ = ready_in.send((tid, host::settle(&plan)));
            drop(ready_in);
            touch_stack();
            if plan.sealed {
                alloc::seal();
            }
            run(&plan, begin, &mut beats, &mut faces, &halt, &stop, &mut Host);
            alloc::unseal();
        })?;
    let (tid, refusals) = ready
        .recv()
        .map_err(|_| std::io::Error::other("the thread ended at once"))?;
    Ok(Beating {
        name,
        samples,
        tid,
        refusals,
        thread,
    })
}

fn face(gauge: Arc<BeatGauge>) -> (Face, Consumer<Sample>) {
    let (samples, out) = RingBuffer::new(SAMPLES_MAX);
    (Face { gauge, samples }, out)
}

/// Touches the stack that the beats will use, so that no beat is the first to.
#[inline(never)]
fn touch_stack() {
    let mut touched = [0_u8; TOUCHED_BYTES];
    for byte in touched.iter_mut().step_by(4096) {
        *byte = std::hint::black_box(1);
    }
    std::hint::black_box(&touched);
}

/// Beats until told to stop.
fn run(
    plan: &Plan,
    begin: Time,
    beats: &mut impl Beats,
    faces: &mut [Face],
    halt: &HaltChannel,
    stop: &AtomicBool,
    timing: &mut impl Timing,
) {
    let mut pace = Pace::new(begin + plan.phase, plan.period, plan.overrun);
    // Relaxed: whether it stops one beat earlier or later does not matter.
    while !stop.load(Ordering::Relaxed) {
        let due = pace.due();
        timing.wait(due, plan.wake);
        let woke = timing.now();
        beats.beat(woke);
        let ended = timing.now();
        let verdict = pace.after(woke, ended);
        let sound = pace.sound();
        if verdict.halt {
            halt.halt(Causes::OVERRUN);
        }
        for (member, face) in faces.iter_mut().enumerate() {
            face.gauge.judged(ended, verdict, sound);
            let sample = Sample {
                due,
                latency: woke.since(due),
                step: beats.took(member).unwrap_or(ended.since(woke)),
                response: ended.since(due),
            };
            if face.samples.push(sample).is_err() {
                face.gauge.lose_sample();
            }
        }
    }
}

#[cfg(test)]
#[path = "policy_tests.rs"]
mod tests;
