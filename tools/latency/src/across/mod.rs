//! Across processes: how long a real-time thread's message takes to a reader in another process, by a wire and by
//! the bare means beside it.
//!
//! ```text
//!   speaker, SCHED_FIFO, a beat each period:   wire · wire again · blackboard · seqlock · wire again · …
//!   listener, another process and processor:   polls the one whose turn it is, notes how old what it found is
//! ```
//! Must never compare one after the other: the four take turns beat by beat, in every order there is, so what
//! disturbs one disturbs all.

mod listener;
mod means;
mod seqlock;

use std::io::Read;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use daemon::executor::gauge::BeatGauge;
use daemon::executor::{self, Beats};
use daemon::halt::HaltChannel;
use hdrhistogram::Histogram;
use ipc::clock::{self, Span, Time};
use ipc::wire::iceoryx::Domain;

use crate::pair::{self, Setting};
use crate::track::histogram;
use means::{Speakers, Stage};

pub use listener::{WORKER, listen};

/// What carries a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Means {
    /// A wire of ours.
    Wire,
    /// Another one: the control.
    WireAgain,
    /// A bare iceoryx2 blackboard.
    Blackboard,
    /// A bare sequence lock in shared memory.
    Seqlock,
}

/// All of them.
pub const MEANS: [Means; 4] = [Means::Wire, Means::WireAgain, Means::Blackboard, Means::Seqlock];

impl Means {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Means::Wire => "wire",
            Means::WireAgain => "wire-again",
            Means::Blackboard => "blackboard",
            Means::Seqlock => "seqlock",
        }
    }
}

/// By what message `number`, counted from 1, is carried: each four in a row are all of them, in every order in turn,
/// as whoever comes first finds the caches in another state than the next.
fn turn(number: u64) -> Means {
    let (four, place) = ((number - 1) / 4, (number - 1) % 4);
    let (mut left, mut among, mut order) = (MEANS, MEANS.len(), (four % 24) as usize);
    for _ in 0..place {
        left.copy_within(order % among + 1..among, order % among);
        order /= among;
        among -= 1;
    }
    left[order % among]
}

/// How old messages were when the other process had them, nanoseconds, one histogram for each of [`MEANS`].
pub type Round = [Histogram<u64>; MEANS.len()];

/// Messages left out at the beginning of a round: caches and idle states settle.
const WARM_UP: u64 = 200;

/// Fewest messages by each means that make a round: a 99th percentile needs some.
const FEWEST: u64 = 100;

/// How long after the end of a round the listener may take to say what it heard.
const LISTENER_WAIT: Span = Span::millis(500);

/// The thread that speaks: by another means at each beat.
struct Speaking {
    speakers: Speakers,
    number: u64,
}

impl Beats for Speaking {
    fn beat(&mut self, _: Time) {
        self.number += 1;
        self.speakers.speak(turn(self.number), self.number);
    }
}

/// What became of a round.
#[derive(Debug)]
pub enum Heard {
    /// It was measured.
    All(Box<Round>),
    /// Its listener had its processor too rarely to hear each of them: the host was busy.
    TooLittle,
    /// It was left before it was over.
    Left,
}

/// Runs one round, unless `leave` says so before it is over.
///
/// # Errors
/// When shared memory, the thread or the listener cannot be had.
pub fn round(setting: &Setting, leave: &dyn Fn() -> bool) -> Result<Heard, String> {
    let name = format!("across{}", std::process::id());
    let domain = Domain::join(&name).map_err(|e| e.to_string())?;
    let (stage, speakers) = Stage::set(&domain, &name)?;
    let begin = (clock::monotonic() + Span::millis(300)).off_tick();
    let end = begin + Span(setting.round.as_nanos() as u64);
    let mut listener = Listener::start(setting, &name, stage.seqlock_path(), end)?;
    let plan = pair::plan(setting, "speaker", Span::ZERO, ipc::wiring::creature::Wake::Sleep);
    let (gauge, stop) = (Arc::new(BeatGauge::default()), Arc::new(AtomicBool::new(false)));
    let speaking = Speaking { speakers, number: 0 };
    let halt = Arc::new(HaltChannel::default());
    let thread =
        executor::start(plan, begin, speaking, vec![gauge], halt, stop.clone()).map_err(|e| e.to_string())?;
    let mut left = false;
    while !left && clock::monotonic() < end + LISTENER_WAIT {
        // The listener gets the page when it asks for it.
        stage.serve();
        std::thread::sleep(Duration::from_millis(20));
        left = leave();
    }
    stop.store(true, Ordering::Relaxed);
    thread.join();
    let heard = if left { None } else { Some(listener.heard()?) };
    drop((listener, stage));
    domain.leave();
    heard.map_or(Ok(Heard::Left), |text| sorted(&text))
}

/// The process that listens; ended when it is dropped.
struct Listener(Child);

impl Listener {
    fn start(setting: &Setting, name: &str, seqlock: String, end: Time) -> Result<Listener, String> {
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let child = Command::new(program)
            .arg0(WORKER)
            .args([name, &seqlock, &end.0.to_string(), &setting.main_cpu.to_string()])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn();
        child
            .map(Listener)
            .map_err(|e| format!("the listener does not start: {e}"))
    }

    /// What it wrote, once it has ended.
    fn heard(&mut self) -> Result<String, String> {
        let mut text = String::new();
        let out = self.0.stdout.as_mut().ok_or("the listener's output is gone")?;
        out.read_to_string(&mut text).map_err(|e| e.to_string())?;
        let status = self.0.wait().map_err(|e| e.to_string())?;
        match status.success() {
            true => Ok(text),
            false => Err(format!("the listener ended with {status}: {text}")),
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The listener's lines, each a message's number and its age, by what carried it.
fn sorted(text: &str) -> Result<Heard, String> {
    let mut round = [histogram(), histogram(), histogram(), histogram()];
    for line in text.lines() {
        let words: Option<(u64, u64)> = line
            .split_once(' ')
            .and_then(|(number, age)| Some((number.parse().ok()?, age.parse().ok()?)));
        let (number, age) = words.ok_or_else(|| format!("the listener says {line:?}"))?;
        if number > WARM_UP {
            round[turn(number) as usize].saturating_record(age.max(1));
        }
    }
    Ok(match round.iter().all(|h| h.len() >= FEWEST) {
        true => Heard::All(Box::new(round)),
        false => Heard::TooLittle,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_four_are_all_means_and_all_orders_come() {
        let orders: std::collections::BTreeSet<Vec<usize>> = (0..24)
            .map(|four| (1..=4).map(|k| turn(4 * four + k) as usize).collect())
            .collect();
        assert_eq!(orders.len(), 24);
        for order in orders {
            assert_eq!(order.iter().map(|k| 1 << k).sum::<usize>(), 15, "{order:?}");
        }
    }

    #[test]
    fn messages_are_sorted_by_whose_turn_it_was() {
        let lines: String = (1..=1000)
            .map(|n| format!("{n} {}\n", 10 * (turn(n) as u64 + 1)))
            .collect();
        let Ok(Heard::All(round)) = sorted(&lines) else {
            panic!("all were heard");
        };
        for means in MEANS {
            let ages = &round[means as usize];
            assert_eq!((ages.len(), ages.max()), (200, 10 * (means as u64 + 1)));
        }
        assert!(matches!(sorted("201 10\n"), Ok(Heard::TooLittle)) && sorted("what\n").is_err());
    }
}
