//! Acts: what happens to Allen during a soak, one after the other, as the seed decides.
//!
//! Must never leave an act half done: what it broke is whole again, and the body free, before the next.

use std::collections::BTreeMap;
use std::io::Write;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use ipc::clock::Span;
use ipc::control::{Reply, Request};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use stage::{Player, Stage, wait_for};

use super::SOAKED;
use crate::observe::Observer;
use crate::outcome::{HOST_LATE, halts};
use crate::rogue::Behaviour;
use crate::trial::Trial;

/// How long the frozen stay so: longer than any stale limit.
const FROZEN: Duration = Duration::from_millis(350);

/// What may happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Act {
    Come,
    Go,
    Kill,
    Freeze,
    Flood,
    Garbage,
    Scribble,
    Churn,
    Callers,
    EmergencyStop,
    FreezeDaemon,
    FreezeBody,
}

/// Each act, how often it is chosen, and what it is called.
const ACTS: [(Act, u64, &str); 12] = [
    (Act::Come, 6, "wander attaches"),
    (Act::Go, 2, "wander leaves"),
    (Act::Kill, 3, "wander dies by SIGKILL"),
    (Act::Freeze, 2, "wander freezes and thaws"),
    (Act::Flood, 2, "a layer floods its tap"),
    (Act::Garbage, 2, "a layer writes what is no message"),
    (Act::Scribble, 2, "a layer scribbles over its memory"),
    (Act::Churn, 2, "four layers come and go in a loop"),
    (Act::Callers, 2, "callers drip, shout and are silent"),
    (Act::EmergencyStop, 1, "emergency stop, and reset"),
    (Act::FreezeDaemon, 1, "the daemon freezes and thaws"),
    (Act::FreezeBody, 1, "the body freezes and thaws"),
];

/// What came of the acts so far.
#[derive(Debug, Default)]
pub(super) struct Tally {
    /// How often each act was done.
    pub(super) done: BTreeMap<&'static str, u64>,
    /// Halts that had to come.
    pub(super) due: u64,
    /// Those that did not.
    pub(super) missed: u64,
    /// Halts that nobody asked for while the host held threads up.
    pub(super) host_halts: u64,
    /// Contacts that the robot caused.
    pub(super) contacts: u64,
    /// Contacts of any kind.
    pub(super) contacts_all: u64,
    /// Allocations on real-time threads.
    pub(super) allocations: u64,
    /// How far the robot went at least, in metres.
    pub(super) went_m: f64,
    /// What is not as it should be.
    pub(super) broken: Vec<String>,
    place: Option<(f64, f64)>,
}

impl Tally {
    /// How many acts there were.
    pub(super) fn acts(&self) -> u64 {
        self.done.values().sum()
    }

    /// Takes in what a status says.
    pub(super) fn look(&mut self, status: &Value) {
        let count = |value: &Value| value.as_u64().unwrap_or(0);
        self.contacts = self.contacts.max(count(&status["contacts"]["caused"]));
        self.contacts_all = self.contacts_all.max(count(&status["contacts"]["all"]));
        self.allocations = self.allocations.max(count(&status["real_time_allocations"]));
        let robot = &status["robot"];
        let Some(now) = robot["x"].as_f64().zip(robot["y"].as_f64()) else {
            return;
        };
        if let Some(before) = self.place {
            self.went_m += f64::hypot(now.0 - before.0, now.1 - before.1);
        }
        self.place = Some(now);
    }
}

/// Allen, and the layers that come and go above it.
pub(super) struct Layers<'t> {
    trial: &'t mut Trial,
    observer: Observer,
    wander: Option<Player>,
    daemon: &'t Player,
    body: Pid,
    /// The status up to which halts were judged.
    judged: Value,
    /// Numbers rogues, so that none is kept out for what another did.
    rogues: u64,
}

impl<'t> Layers<'t> {
    /// Over a daemon that runs.
    pub(super) fn over(trial: &'t mut Trial, daemon: &'t Player, body: Pid) -> Result<Layers<'t>, String> {
        Ok(Layers {
            observer: Observer::of_the_body(Span::ZERO)?,
            judged: trial.stage.status(SOAKED),
            trial,
            wander: None,
            daemon,
            body,
            rogues: 0,
        })
    }

    pub(super) fn stage(&self) -> &Stage {
        &self.trial.stage
    }

    pub(super) fn status(&self) -> Value {
        self.trial.stage.status(SOAKED)
    }

    /// A pause of up to half a second.
    pub(super) fn rest(&mut self) {
        let pause = self.trial.draw() % Span::millis(500).0;
        std::thread::sleep(Duration::from_nanos(pause));
    }

    /// Does what the seed decides, and looks what came of it.
    pub(super) fn act(&mut self, tally: &mut Tally) -> Result<(), String> {
        let (act, name) = self.choose();
        let before = self.status();
        let cause = self.do_it(act).map_err(|e| format!("{name}: {e}"))?;
        *tally.done.entry(name).or_default() += 1;
        self.wait_until_free()
            .map_err(|e| format!("after {name:?}: {e}; it stands {}", self.status()["halt"]))?;
        // One look of the daemon's watcher later, everything is in its status.
        std::thread::sleep(Duration::from_millis(120));
        let after = self.status();
        if let Some(cause) = cause {
            tally.due += 1;
            if count_of(&after, cause) <= count_of(&before, cause) {
                tally.missed += 1;
                tally
                    .broken
                    .push(format!("MISSED: {name}: no halt for {cause:?}"));
            }
        } else {
            // In the pause before it as well.
            let more = halts(&after).saturating_sub(halts(&self.judged));
            match more == 0 || self.held_up(&after) {
                true => tally.host_halts += more,
                false => tally.broken.push(format!(
                    "{name}: the body was halted: {}",
                    after["halt"]["counts"]
                )),
            }
        }
        self.judged = after;
        self.observer.begin();
        Ok(())
    }

    /// Waits until the body is free. A halt that latched while the host held threads up is taken back.
    fn wait_until_free(&mut self) -> Result<(), String> {
        let is_free = || self.trial.stage.is_free(SOAKED);
        wait_for("the body is free, or halted for good", || {
            is_free() || self.trial.is_latched()
        })?;
        match self.trial.is_latched() && self.held_up(&self.status()) {
            true => self.trial.reset(self.daemon),
            false => wait_for("the body is free", is_free),
        }
    }

    /// Whether the host held real-time threads up since halts were judged last, so long that one may be its doing.
    fn held_up(&self, now: &Value) -> bool {
        self.observer.late() > HOST_LATE || missed(now) > missed(&self.judged)
    }

    fn choose(&mut self) -> (Act, &'static str) {
        let sum: u64 = ACTS.iter().map(|(_, weight, _)| weight).sum();
        let mut left = self.trial.draw() % sum;
        let mut chosen = ACTS[0];
        for act in ACTS {
            chosen = act;
            if left < act.1 {
                break;
            }
            left -= act.1;
        }
        // Who is not there can't leave, and who is can't come.
        let there = self.wander.is_some();
        let index = match chosen.0 {
            Act::Come if there => 1,
            Act::Go | Act::Kill | Act::Freeze if !there => 0,
            _ => return (chosen.0, chosen.2),
        };
        (ACTS[index].0, ACTS[index].2)
    }

    /// Does it; gives the cause of the halt that has to come of it.
    fn do_it(&mut self, act: Act) -> Result<Option<&'static str>, String> {
        match act {
            Act::Come => self.wander = Some(self.trial.wander()?),
            Act::Go => self.wander.take().map_or(Ok(()), |mut w| w.leave())?,
            Act::Kill => {
                if let Some(mut wander) = self.wander.take() {
                    wander.end_by(Signal::KILL)?;
                }
            }
            Act::Freeze => {
                if let Some(wander) = &self.wander {
                    wander.signal(Signal::STOP);
                    std::thread::sleep(FROZEN);
                    wander.signal(Signal::CONT);
                }
            }
            Act::Flood => {
                let mut rogue = self.rogue(Behaviour::Flood)?;
                rogue.says("let go", 1)?;
                rogue.end()?;
            }
            Act::Garbage => self.for_a_while(&[Behaviour::Garbage])?,
            Act::Scribble => self.for_a_while(&[Behaviour::Scribble])?,
            Act::Churn => self.for_a_while(&[Behaviour::Churn; 4])?,
            Act::Callers => self.callers(),
            Act::EmergencyStop => {
                self.ask(&Request::Halt)?;
                wait_for("it is halted", || self.status()["halt"]["latched"] == true)?;
                self.trial.reset(self.daemon)?;
                return Ok(Some("emergency stop"));
            }
            Act::FreezeDaemon => {
                freeze(self.trial.daemon_pid()?)?;
                return Ok(Some("stale command"));
            }
            Act::FreezeBody => {
                freeze(self.body)?;
                return Ok(Some("body lost"));
            }
        }
        Ok(None)
    }

    fn ask(&self, request: &Request) -> Result<(), String> {
        match self.trial.stage.ask(SOAKED, request) {
            Some(Reply::Done) => Ok(()),
            other => Err(format!("{request:?} was answered with {other:?}")),
        }
    }

    fn rogue(&mut self, how: Behaviour) -> Result<Player, String> {
        self.rogues += 1;
        self.trial.rogue(how, &format!("{}{}", how.name(), self.rogues))
    }

    fn for_a_while(&mut self, behaviours: &[Behaviour]) -> Result<(), String> {
        let mut rogues = Vec::new();
        for how in behaviours {
            rogues.push(self.rogue(*how)?);
        }
        self.rest();
        std::thread::sleep(FROZEN);
        for (rogue, how) in rogues.iter_mut().zip(behaviours) {
            // Killed while iceoryx2 makes or removes its node it would leave files that nobody removes.
            if *how == Behaviour::Churn {
                rogue.leave()?;
                continue;
            }
            rogue.says("attached", 1)?;
            rogue.end_by(Signal::KILL)?;
        }
        Ok(())
    }

    /// Twenty callers who say half a word, too much, or nothing.
    fn callers(&mut self) {
        let mut callers = Vec::new();
        for _ in 0..20 {
            let Ok(mut caller) = UnixStream::connect(self.trial.stage.socket(SOAKED)) else {
                continue;
            };
            let _ = caller.set_write_timeout(Some(Duration::from_millis(50)));
            let length = self.trial.draw() % 5_000;
            let bytes: Vec<u8> = (0..length).map(|_| self.trial.draw() as u8).collect();
            let _ = caller.write_all(&bytes);
            callers.push(caller);
        }
    }

    /// Takes every place that callers may have, once: a C library keeps the stacks of threads that have ended, and
    /// what it keeps from the busiest moment on is no growth.
    pub(super) fn fill(&self) {
        let places = 0..2 * daemon::callers::CALLERS_MAX;
        let callers: Vec<_> = places.filter_map(|_| self.trial.stage.connect(SOAKED)).collect();
        drop(callers);
    }

    /// All layers leave.
    pub(super) fn leave_all(mut self, tally: &mut Tally) {
        if let Some(mut wander) = self.wander.take() {
            tally.broken.extend(wander.leave().err());
        }
        tally.look(&self.status());
    }
}

fn freeze(pid: Pid) -> Result<(), String> {
    let send = |signal| kill_process(pid, signal).map_err(|e| format!("a signal: {e}"));
    send(Signal::STOP)?;
    std::thread::sleep(FROZEN);
    send(Signal::CONT)
}

/// How often a cause began.
fn count_of(status: &Value, cause: &str) -> u64 {
    let mut counts = status["halt"]["counts"].as_array().into_iter().flatten();
    let counted = counts.find(|c| c["cause"] == cause);
    counted.and_then(|c| c["count"].as_u64()).unwrap_or(0)
}

/// Beats that missed their deadlines, of all real-time threads.
fn missed(status: &Value) -> u64 {
    let layers = status["layers"].as_array().into_iter().flatten();
    layers.filter_map(|l| l["missed"].as_u64()).sum()
}
