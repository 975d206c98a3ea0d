//! The executor: fixed-period threads that beat.
//!
//! ```text
//!   sleep until due ─► look at the clock ─► step ─► commit ─► count ─► next due (policy if late)
//! ```
//! Must never do anything on a beating thread, once it is sealed, but this: no allocation, no lock, no page
//! fault, no system call other than the sleep.

pub mod gauge;
pub mod host;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use ipc::clock::{self, Span, Time};
use ipc::wiring::creature::Overrun;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::alloc;
use crate::gate::Causes;
use crate::halt::HaltChannel;
use gauge::{BeatGauge, SAMPLES_MAX, Sample};
use host::Refusal;

/// Something that beats.
pub trait Beats: Send + 'static {
    /// One beat, due now.
    fn beat(&mut self, now: Time);
}

/// How a thread beats.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The thread's name.
    pub name: String,
    /// Time between beats.
    pub period: Span,
    /// Where the beats lie within the period.
    pub phase: Span,
    /// SCHED_FIFO priority; none to stay with the ordinary scheduler.
    pub priority: Option<u8>,
    /// The processor it is bound to.
    pub cpu: Option<usize>,
    /// What happens when a beat runs over its period.
    pub overrun: Overrun,
    /// Whether it is expected to allocate nothing once it beats.
    pub sealed: bool,
}

/// A thread that beats.
#[derive(Debug)]
pub struct Beating {
    /// Its name.
    pub name: String,
    /// Samples of its beats, to be drained by a watcher.
    pub samples: Consumer<Sample>,
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

/// Starts a thread that beats until `stop`. Its first beat is the first of its grid after `begin`.
///
/// # Errors
/// When the host refuses the thread itself.
pub fn start(
    plan: Plan,
    begin: Time,
    mut beats: impl Beats,
    gauge: Arc<BeatGauge>,
    halt: Arc<HaltChannel>,
    stop: Arc<AtomicBool>,
) -> std::io::Result<Beating> {
    let (sample_in, samples) = RingBuffer::new(SAMPLES_MAX);
    let (ready_in, ready) = std::sync::mpsc::channel();
    let name = plan.name.clone();
    let thread = std::thread::Builder::new()
        .name(name.clone())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            let tid = rustix::thread::gettid().as_raw_nonzero().get();
            let _ = ready_in.send((tid, settle(&plan)));
            drop(ready_in);
            touch_stack();
            if plan.sealed {
                alloc::seal();
            }
            run(&plan, begin, &mut beats, &gauge, &halt, &stop, sample_in);
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

/// Asks the host for what the plan wants.
fn settle(plan: &Plan) -> Vec<Refusal> {
    let bound = plan.cpu.map_or(Ok(()), host::bind);
    let scheduled = plan.priority.map_or(Ok(()), host::schedule_fifo);
    [bound, scheduled].into_iter().filter_map(Result::err).collect()
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
    gauge: &BeatGauge,
    halt: &HaltChannel,
    stop: &AtomicBool,
    mut samples: Producer<Sample>,
) {
    let mut due = begin + plan.phase;
    // Relaxed: whether it stops one beat earlier or later does not matter.
    while !stop.load(Ordering::Relaxed) {
        clock::sleep_until(due);
        let woke = clock::monotonic();
        beats.beat(woke);
        let ended = clock::monotonic();
        gauge.beat(ended);
        let sample = Sample {
            latency: woke.since(due),
            step: ended.since(woke),
        };
        if samples.push(sample).is_err() {
            gauge.lose_sample();
        }
        due = due + plan.period;
        if ended > due {
            due = after_overrun(plan, due, ended, gauge, halt);
        }
    }
}

/// Applies the overrun policy: the beat due at `due` could not begin before `ended`.
fn after_overrun(plan: &Plan, due: Time, ended: Time, gauge: &BeatGauge, halt: &HaltChannel) -> Time {
    let missed = ended.since(due).0.div_ceil(plan.period.0);
    match plan.overrun {
        Overrun::CatchUp => {
            gauge.overrun(0);
            due
        }
        Overrun::Skip | Overrun::Halt => {
            gauge.overrun(missed);
            if plan.overrun == Overrun::Halt {
                halt.halt(Causes::OVERRUN);
            }
            due + Span(missed * plan.period.0)
        }
    }
}
