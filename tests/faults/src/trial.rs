//! A trial: one fault, injected once or in several rounds on one stage, with what the seed decides and what came of it.
//!
//! Must never inject before the body is free: a fault that is not needed for the halt shows nothing.

use ipc::clock::{self, Span, Time};
use ipc::control::{Event, Reply, Request};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use stage::{Player, Stage, wait_for};

use crate::draws::Draws;
use crate::inside;
use crate::observe::Observer;
use crate::outcome::Outcome;
use crate::programs::Programs;
use crate::rogue::Behaviour;

/// Name of the creature of every stage.
pub(crate) const CREATURE: &str = "tried";

/// Name of its body, where that is a process of its own.
pub(crate) const BODY: &str = "hall";

/// How long a process of a stage lives at most, and as much again for every round: it ends by itself should nobody be
/// left to end it.
const LIFE_S: u64 = 180;
const LIFE_MORE_S: u64 = 10;

/// What of Allen's file and body a bound is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Period of watchdog, motor unit and body.
    pub(crate) period: Span,
    /// How old a command or a pulse may be at the other end.
    pub(crate) stale: Span,
}

/// A trial.
#[derive(Debug)]
pub(crate) struct Trial {
    pub(crate) programs: Programs,
    pub(crate) stage: Stage,
    pub(crate) outcome: Outcome,
    pub(crate) limits: Limits,
    random: Draws,
    /// How often the fault is injected.
    rounds: u64,
    /// The newest event before the round.
    noted: u64,
    /// How long a process lives at most, in seconds.
    pub(crate) life_s: String,
}

impl Trial {
    /// On the stage that this process was started on.
    ///
    /// # Errors
    /// When there is none, or a program is missing.
    pub(crate) fn new(seed: u64, rounds: u64) -> Result<Trial, String> {
        let kinds = daemon::machine::kinds();
        let source = ipc::wiring::Source::new("allen.toml", allen::CREATURE);
        let creature = ipc::wiring::check::creature(&source, &kinds).map_err(|e| e.to_string())?;
        let body = creature.body.ok_or("Allen has no body")?;
        let kind = daemon::body::find(body.declaration.name).ok_or("Allen's body is of no known kind")?;
        Ok(Trial {
            programs: Programs::beside_us()?,
            stage: Stage::inherited().ok_or("this process is on no stage")?,
            outcome: Outcome::default(),
            limits: Limits {
                period: body.period,
                stale: kind.stale,
            },
            random: Draws(seed),
            rounds,
            noted: 0,
            life_s: (LIFE_S + rounds * LIFE_MORE_S).to_string(),
        })
    }

    /// The same with processes that live for `seconds` and a while.
    pub(crate) fn living(mut self, seconds: f64) -> Trial {
        self.life_s = (seconds + LIFE_S as f64).to_string();
        self
    }

    /// The next number that the seed decides.
    pub(crate) fn draw(&mut self) -> u64 {
        self.random.draw()
    }

    /// Waits a while that the seed decides, so that the fault meets every phase of every period.
    pub(crate) fn wait_a_while(&mut self) {
        let span = self.draw() % Span::millis(120).0;
        clock::sleep_until(clock::monotonic() + Span(span));
    }

    /// The daemon, its body free.
    pub(crate) fn daemon(&mut self, arguments: &[&str]) -> Result<Player, String> {
        let mut all = vec!["--name", CREATURE, "--headless", "--seconds", &self.life_s];
        all.extend(arguments);
        let player = self.stage.start(&self.programs.subsumed, &all)?;
        self.wait_until_free(&player)?;
        Ok(player)
    }

    /// A process that runs Allen's body.
    pub(crate) fn body(&self) -> Result<Player, String> {
        let body = self
            .stage
            .start(&self.programs.body, &["--name", BODY, "--seconds", &self.life_s])?;
        body.says("waits for a daemon", 1)?;
        Ok(body)
    }

    /// Level 1 of Allen as a process, attached.
    pub(crate) fn wander(&self) -> Result<Player, String> {
        self.wander_with(&[])
    }

    /// The same with further variables.
    pub(crate) fn wander_with(&self, variables: &[(&str, &str)]) -> Result<Player, String> {
        let arguments = ["--creature", CREATURE];
        let wander = self
            .stage
            .start_with(&self.programs.wander, &arguments, variables)?;
        // Its own word: the status may still show one before it, and events be left out where many come and go.
        wander.says("attached to", 1)?;
        Ok(wander)
    }

    /// A layer process that misbehaves, as layer `name`.
    pub(crate) fn rogue(&mut self, how: Behaviour, name: &str) -> Result<Player, String> {
        let seed = self.draw().to_string();
        let arguments = ["rogue", how.name(), name, "--seconds", "30", "--seed", &seed];
        self.stage.start(&self.programs.ourselves, &arguments)
    }

    /// Waits until the daemon answers and its body is free. A halt that the host caused and that latched is taken back.
    pub(crate) fn wait_until_free(&mut self, daemon: &Player) -> Result<(), String> {
        let waited = wait_for("the body is free, or halted for good", || {
            self.stage.is_free(CREATURE) || self.is_latched()
        });
        waited.map_err(|e| {
            let halt = self.stage.status(CREATURE)["halt"].to_string();
            format!("{e}; it stands {halt}, the daemon said {:?}", daemon.said())
        })?;
        if !self.is_latched() {
            return Ok(());
        }
        self.blame_the_host();
        self.reset(daemon)
    }

    /// Whether the body is halted for a cause that latches.
    pub(crate) fn is_latched(&self) -> bool {
        self.stage.status(CREATURE)["halt"]["latched"] == true
    }

    /// Takes back a halt that latched.
    pub(crate) fn reset(&mut self, daemon: &Player) -> Result<(), String> {
        let mut answer = None;
        // Refused for as long as the cause stands.
        wait_for("a reset is granted", || {
            answer = self.stage.ask(CREATURE, &Request::Reset);
            answer == Some(Reply::Done)
        })
        .map_err(|e| format!("{e}: {answer:?}"))?;
        // It takes effect with the motor unit's next beat.
        wait_for("the reset takes effect", || !self.is_latched())?;
        self.wait_until_free(daemon)
    }

    /// Counts a halt that latched without a fault as the host's, if that is what it was: some thread was held up for
    /// half a period of the layer on trial.
    pub(crate) fn blame_the_host(&mut self) {
        let status = self.stage.status(CREATURE);
        let layers = status["layers"].as_array().into_iter().flatten();
        // How long the step on trial lasted, the fault decides.
        let times = layers.flat_map(|l| {
            let step = (l["name"] != "trial").then_some(&l["step_us"]["max"]);
            step.into_iter().chain([&l["latency_us"]["max"]])
        });
        let longest_us = times.filter_map(Value::as_f64).fold(0.0, f64::max);
        let held_up = longest_us * 1e3 > inside::PERIOD.0 as f64 / 2.0;
        self.outcome.host_halts += u64::from(held_up);
        self.outcome.expect(held_up, || {
            format!("the body was halted without a fault: {}", status["halt"])
        });
    }

    /// Waits until the daemon answers everybody again, twenty times in a row: those who took all places are gone, and
    /// seen to be.
    pub(crate) fn wait_until_answered(&self) -> Result<(), String> {
        wait_for("everybody is answered", || {
            (0..20).all(|_| self.stage.status(CREATURE).is_object())
        })
    }

    /// Runs `round` as often as the fault is to be injected.
    pub(crate) fn in_rounds(
        &mut self,
        mut round: impl FnMut(&mut Trial) -> Result<(), String>,
    ) -> Result<(), String> {
        (0..self.rounds).try_for_each(|_| {
            self.outcome.injections += 1;
            round(self)
        })
    }

    /// Tries a fault that must not halt the body: the daemon goes on. The body is a process of its own, whose
    /// world turns in real time: one inside the daemon is an ordinary thread, and lost when the host is busy.
    pub(crate) fn goes_on(
        &mut self,
        fault: impl FnMut(&mut Trial) -> Result<(), String>,
    ) -> Result<(), String> {
        let mut body = self.body()?;
        let daemon = self.daemon(&["--body", BODY])?;
        self.wait_for_looks()?;
        self.goes_on_with(daemon, fault)?;
        leave_body(self, &mut body);
        Ok(())
    }

    /// The same with a daemon that was started in another way.
    pub(crate) fn goes_on_with(
        &mut self,
        mut daemon: Player,
        mut fault: impl FnMut(&mut Trial) -> Result<(), String>,
    ) -> Result<(), String> {
        let observer = Observer::of_the_host()?;
        let before = self.stage.status(CREATURE);
        let tried = self.in_rounds(|trial| {
            trial.wait_a_while();
            trial.noted = trial.stage.events(CREATURE).last().map_or(0, |e| e.number);
            fault(trial)
        });
        tried.map_err(|e| format!("{e}; the daemon last said {:?}", daemon.said().last()))?;
        // Two looks of the daemon's own watcher: what the fault did is in its status.
        clock::sleep_until(clock::monotonic() + Span::millis(250));
        let after = self.stage.status(CREATURE);
        self.outcome.host_late = self.outcome.host_late.max(observer.late());
        self.outcome.inspect(&after);
        self.outcome.expect_no_halt(&before, &after);
        let (was, is) = (beats_of_level_0(&before), beats_of_level_0(&after));
        // It beats every 10 ms; ten beats of the 25 and more that are due.
        self.outcome.expect(is > was + 10, || {
            format!("level 0 beat {was} times before, {is} after")
        });
        self.outcome.expect(self.stage.is_free(CREATURE), || {
            "the body does not stay free".into()
        });
        self.end(&mut daemon)
    }

    /// Waits until an event of this round holds all of `parts`.
    pub(crate) fn told(&self, parts: &[&str]) -> Result<(), String> {
        let holds =
            |event: &Event| event.number > self.noted && parts.iter().all(|part| event.text.contains(part));
        wait_for(&format!("an event says {parts:?}"), || {
            self.stage.events(CREATURE).iter().any(holds)
        })
    }

    /// Ends a daemon in good order.
    pub(crate) fn end(&mut self, daemon: &mut Player) -> Result<(), String> {
        if let Err(trouble) = daemon.leave() {
            self.outcome.broken.push(trouble);
        }
        Ok(())
    }

    /// Notes the time from `fault` to `halted`, which may take `bound`, while `observer` looked on.
    pub(crate) fn halted(&mut self, fault: Time, halted: Option<Time>, bound: Span, observer: &Observer) {
        self.outcome.period = Some(self.limits.period);
        let halted = halted.map(|at| at.since(fault));
        self.outcome.halted(halted, bound, observer.late());
    }

    /// Starts the daemon again after a death, with the body process that saw it, and looks whether all is well.
    pub(crate) fn restart(&mut self) -> Result<Player, String> {
        let began = clock::monotonic();
        let daemon = self.daemon(&["--body", BODY])?;
        let took = clock::monotonic().since(began);
        self.outcome.restart = self.outcome.restart.max(Some(took));
        self.look_at_status()?;
        Ok(daemon)
    }

    /// Waits until the body has told how it looks: with that, contacts are counted.
    pub(crate) fn wait_for_looks(&self) -> Result<(), String> {
        wait_for("the body tells how it looks", || {
            self.stage.status(CREATURE)["contacts"].is_object()
        })
    }

    /// Takes in what the daemon's status says, as soon as the body tells how it looks.
    pub(crate) fn look_at_status(&mut self) -> Result<(), String> {
        self.wait_for_looks()?;
        self.outcome.inspect(&self.stage.status(CREATURE));
        Ok(())
    }

    /// The daemon that answers.
    pub(crate) fn daemon_pid(&self) -> Result<Pid, String> {
        let pid = self.stage.status(CREATURE)["pid"].as_i64();
        let pid = pid.and_then(|pid| i32::try_from(pid).ok());
        pid.and_then(Pid::from_raw)
            .ok_or_else(|| "the status names no process".into())
    }

    /// Sends the daemon that answers a signal.
    pub(crate) fn signal_daemon(&self, signal: Signal) -> Result<(), String> {
        kill_process(self.daemon_pid()?, signal).map_err(|e| format!("a signal: {e}"))
    }
}

fn beats_of_level_0(status: &Value) -> u64 {
    let layers = status["layers"].as_array().into_iter().flatten();
    let mut level_0 = layers.filter(|l| l["level"] == 0);
    level_0.next().and_then(|l| l["beats"].as_u64()).unwrap_or(0)
}

/// Brings a body process to its end in good order.
pub(crate) fn leave_body(trial: &mut Trial, body: &mut Player) {
    if let Err(trouble) = body.leave() {
        trial.outcome.broken.push(trouble);
    }
}
