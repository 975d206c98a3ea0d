//! Faults of the daemon and of the body's process: dead, frozen, broken inside. Each of them halts.
//!
//! Must never take the daemon's word for a halt where the daemon is what broke: the body's own pulse says so.

use ipc::clock::{self, Span, Time};
use ipc::control::{Reply, Request};
use rustix::process::Signal;
use stage::{Player, wait_for};

use crate::inside::{self, Break};
use crate::observe::Observer;
use crate::trial::{BODY, CREATURE, Trial, leave_body};

/// How long the kernel lets a real-time thread run without sleeping before it ends the process, with the ticks
/// in which it counts.
const RUNAWAY: Span = Span::millis(520);

/// The daemon that drives a body process dies by `signal`.
pub(crate) fn daemon_dies(trial: &mut Trial, signal: Signal) -> Result<(), String> {
    let mut body = trial.body()?;
    let mut daemon = trial.daemon(&["--body", BODY])?;
    trial.in_rounds(|trial| {
        let (observer, fault) = at_a_free_moment(trial)?;
        observer.while_breaking(fault, || daemon.signal(signal));
        body_halts(trial, &observer, fault);
        daemon.end()?;
        drop(observer);
        daemon = trial.restart()?;
        Ok(())
    })?;
    trial.end(&mut daemon)?;
    leave_body(trial, &mut body);
    Ok(())
}

/// The daemon that drives a body process freezes, and thaws.
pub(crate) fn daemon_freezes(trial: &mut Trial) -> Result<(), String> {
    let mut body = trial.body()?;
    let mut daemon = trial.daemon(&["--body", BODY])?;
    trial.in_rounds(|trial| {
        let (observer, fault) = at_a_free_moment(trial)?;
        observer.while_breaking(fault, || daemon.freeze())?;
        body_halts(trial, &observer, fault);
        daemon.signal(Signal::CONT);
        wait_for("the body is free after the thaw", || observer.is_open())?;
        drop(observer);
        trial.wait_until_free(&daemon)
    })?;
    leave_both(trial, &mut daemon, &mut body)
}

/// The body's process dies or freezes; the daemon halts until one of its name is back.
pub(crate) fn body_lost(trial: &mut Trial, signal: Signal) -> Result<(), String> {
    lives_on(trial, Break::Busy, |trial, daemon, body| {
        let (observer, fault) = at_a_free_moment(trial)?;
        observer.while_breaking(fault, || match signal {
            Signal::STOP => body.freeze(),
            _ => {
                body.signal(signal);
                Ok(())
            }
        })?;
        let bound = Span(trial.limits.stale.0 + 2 * trial.limits.period.0);
        halts(trial, daemon, "body lost", fault, bound, &observer);
        drop(observer);
        if signal == Signal::STOP {
            body.signal(Signal::CONT);
        } else {
            body.end()?;
            *body = trial.body()?;
        }
        trial.wait_until_free(daemon)
    })
}

/// A layer with `overrun = "halt"` overruns inside the daemon, which halts within two periods of the watchdog after the
/// step that was too long, and lives.
pub(crate) fn overruns_inside(trial: &mut Trial) -> Result<(), String> {
    lives_on(trial, Break::Overrun, |trial, daemon, _| {
        let (observer, fault) = broken_before_halted(trial, daemon, Break::Overrun, "overrun")?;
        let bound = Span(2 * inside::PERIOD.0 + 2 * trial.limits.period.0);
        halts(trial, daemon, "overrun", fault, bound, &observer);
        drop(observer);
        // An overrun latches, and the beat after one may come late for its sake: nobody resets sooner than that.
        clock::sleep_until(clock::monotonic() + Span(4 * inside::PERIOD.0));
        trial.reset(daemon)
    })
}

/// A vital layer inside the daemon never returns: the daemon halts within two periods of the watchdog after it has been
/// silent for too long; then the kernel ends the daemon.
pub(crate) fn loops_inside(trial: &mut Trial) -> Result<(), String> {
    const CAUSE: &str = "vital layer late";
    /// How long a vital layer may be silent: its last beat was up to a period before the fault.
    const VITAL_LATE: Span = Span::millis(50);
    dies_each_time(trial, Break::Loop, |trial, daemon| {
        let best_effort = trial.stage.status(CREATURE)["mode"] == "best effort";
        let (observer, fault) = broken_before_halted(trial, daemon, Break::Loop, CAUSE)?;
        let bound = Span(VITAL_LATE.0 + 2 * trial.limits.period.0);
        halts(trial, daemon, CAUSE, fault, bound, &observer);
        if best_effort {
            // Without SCHED_FIFO the thread starves nobody, and nobody ends it.
            daemon.signal(Signal::KILL);
        }
        runs_away(trial, daemon, &observer, fault)
    })
}

/// The kernel ends a daemon one of whose real-time threads never sleeps; the body's own gate has closed then.
fn runs_away(trial: &mut Trial, daemon: &mut Player, observer: &Observer, fault: Time) -> Result<(), String> {
    daemon.end()?;
    let closed = body_closes(observer, fault).map(|at| at.since(fault));
    let bound = Span(RUNAWAY.0 + trial.limits.stale.0 + trial.limits.period.0 + observer.late().0);
    trial.outcome.expect(closed.is_some_and(|c| c <= bound), || {
        format!("the body's own gate closed after {closed:?}, bound {bound}")
    });
    Ok(())
}

/// A layer inside the daemon overruns under policy skip: its beats are skipped, nothing halts.
pub(crate) fn skips_inside(trial: &mut Trial) -> Result<(), String> {
    let mut body = trial.body()?;
    let daemon = on_trial(trial, Break::Skip)?;
    trial.goes_on_with(daemon, |trial| {
        let skipped = |trial: &Trial| {
            let status = trial.stage.status(CREATURE);
            let mut layers = status["layers"].as_array().into_iter().flatten();
            layers
                .find(|l| l["name"] == "trial")
                .and_then(|l| l["skipped"].as_u64())
        };
        let before = skipped(trial);
        trial.signal_daemon(Signal::USR1)?;
        wait_for("its beats are skipped", || skipped(trial) > before)
    })?;
    leave_body(trial, &mut body);
    Ok(())
}

/// A module inside the daemon panics: the process is gone, the body's own gate closes.
pub(crate) fn panics_inside(trial: &mut Trial) -> Result<(), String> {
    dies_each_time(trial, Break::Panic, |trial, daemon| {
        let (observer, _) = at_a_free_moment(trial)?;
        let fault = broken(daemon)?;
        let status = daemon.end()?;
        let ended = clock::monotonic();
        let closed = body_closes(&observer, fault);
        // Until the message is written the daemon lives, with its gate closed: commands of zero, which are fresh. Where
        // it does not come to say when that gate closed, what it lived on for is added to the bound.
        let told = closed_for(daemon, "panic", fault);
        if told.is_none() {
            observer.held_up(ended.since(fault));
        }
        let bound = trial.limits.stale + trial.limits.period + trial.limits.period;
        trial.halted(fault, told.into_iter().chain(closed).min(), bound, &observer);
        trial
            .outcome
            .expect(!status.success(), || format!("after a panic: {status}"));
        Ok(())
    })
}

/// SIGTERM in the middle of a long step: halted first, then left in good order.
pub(crate) fn ends_in_mid_step(trial: &mut Trial) -> Result<(), String> {
    dies_each_time(trial, Break::Busy, |trial, daemon| {
        let (observer, fault) = at_a_free_moment(trial)?;
        observer.while_breaking(fault, || daemon.signal(Signal::TERM));
        // The signal is looked for as often as once a period.
        let bound = Span(3 * trial.limits.period.0);
        halts(trial, daemon, "shutdown", fault, bound, &observer);
        let status = daemon.end()?;
        trial
            .outcome
            .expect(status.success(), || format!("after SIGTERM: {status}"));
        let closed = body_closes(&observer, fault);
        trial
            .outcome
            .expect(closed.is_some(), || "the body's own gate stays open".into());
        Ok(())
    })
}

/// Somebody presses the emergency stop.
pub(crate) fn emergency_stop(trial: &mut Trial) -> Result<(), String> {
    lives_on(trial, Break::Busy, |trial, daemon, _| {
        let mut connection = trial
            .stage
            .connect(CREATURE)
            .ok_or("the daemon does not answer")?;
        let (observer, fault) = at_a_free_moment(trial)?;
        let answer = observer.while_breaking(fault, || connection.ask(&Request::Halt));
        let answer = answer.map_err(|e| e.to_string())?;
        trial.outcome.expect(answer == Reply::Done, || {
            format!("a halt was answered with {answer:?}")
        });
        // Two periods as for any fault, and one for the thread that hears the caller, which is an ordinary one.
        let bound = Span(3 * trial.limits.period.0);
        halts(trial, daemon, "emergency stop", fault, bound, &observer);
        drop(observer);
        trial.reset(daemon)
    })
}

/// Rounds of one daemon with a module on trial, which lives through all of them, as its body does.
fn lives_on(
    trial: &mut Trial,
    how: Break,
    mut round: impl FnMut(&mut Trial, &mut Player, &mut Player) -> Result<(), String>,
) -> Result<(), String> {
    let mut body = trial.body()?;
    let mut daemon = on_trial(trial, how)?;
    trial.in_rounds(|trial| round(trial, &mut daemon, &mut body))?;
    leave_both(trial, &mut daemon, &mut body)
}

/// Rounds each of which a daemon with a module on trial does not outlive, and the next one starts at once; the body lives
/// through all of them.
fn dies_each_time(
    trial: &mut Trial,
    how: Break,
    mut round: impl FnMut(&mut Trial, &mut Player) -> Result<(), String>,
) -> Result<(), String> {
    let mut body = trial.body()?;
    trial.in_rounds(|trial| {
        let mut daemon = on_trial(trial, how)?;
        round(trial, &mut daemon)?;
        let mut daemon = trial.restart()?;
        trial.end(&mut daemon)
    })?;
    leave_body(trial, &mut body);
    Ok(())
}

/// Looks once more at a daemon that has lived through all rounds, and brings it and its body to their end.
fn leave_both(trial: &mut Trial, daemon: &mut Player, body: &mut Player) -> Result<(), String> {
    trial.look_at_status()?;
    trial.end(daemon)?;
    leave_body(trial, body);
    Ok(())
}

/// The daemon with a module on trial, its body free.
fn on_trial(trial: &mut Trial, how: Break) -> Result<Player, String> {
    let arguments = ["inside", how.name(), "--seconds", &trial.life_s];
    let daemon = trial.stage.start(&trial.programs.ourselves, &arguments)?;
    trial.wait_until_free(&daemon)?;
    trial.wait_for_looks()?;
    Ok(daemon)
}

/// An observer, and a moment at which the body's own gate is open.
pub(crate) fn at_a_free_moment(trial: &mut Trial) -> Result<(Observer, Time), String> {
    let observer = Observer::of_the_body(trial.limits.period)?;
    trial.wait_a_while();
    wait_for("the body's own gate is open", || observer.is_open())?;
    observer.begin();
    Ok((observer, clock::monotonic()))
}

/// Breaks the module on trial at a free moment; when it broke. Halted for the same cause just before, which is the
/// host's doing, a daemon cannot show that the fault halts it: then another one is tried in its place.
fn broken_before_halted(
    trial: &mut Trial,
    daemon: &mut Player,
    how: Break,
    cause: &str,
) -> Result<(Observer, Time), String> {
    loop {
        let (observer, began) = at_a_free_moment(trial)?;
        // What it told before is of earlier rounds, unless it stands.
        let since = if trial.is_latched() { Time(0) } else { began };
        let fault = broken(daemon)?;
        if closed_for(daemon, cause, since).is_none_or(|at| at >= fault) {
            return Ok((observer, fault));
        }
        trial.blame_the_host();
        daemon.signal(Signal::KILL);
        daemon.end()?;
        *daemon = on_trial(trial, how)?;
    }
}

/// Breaks the module on trial; when it broke, by its own word.
fn broken(daemon: &Player) -> Result<Time, String> {
    let times = || -> Vec<u64> {
        let said = daemon.said();
        let numbers = said
            .iter()
            .filter_map(|l| l.strip_prefix("fault ")?.trim().parse().ok());
        numbers.collect()
    };
    let before = times().len();
    daemon.signal(Signal::USR1);
    wait_for("it says when it broke", || times().len() > before)
        .map_err(|e| format!("{e}; it said {:?}", daemon.said()))?;
    // A panic says so twice.
    times()
        .get(before)
        .copied()
        .map(Time)
        .ok_or_else(|| "it says no time".into())
}

/// Waits for the body's own gate to close after `fault`; none when it doesn't.
fn body_closes(observer: &Observer, fault: Time) -> Option<Time> {
    let _ = wait_for("the body's own gate closes", || {
        observer.closed_after(fault).is_some()
    });
    observer.closed_after(fault)
}

/// Waits for the body's own gate to close: within its stale limit and one of its periods.
fn body_halts(trial: &mut Trial, observer: &Observer, fault: Time) {
    body_halts_about(trial, observer, fault, fault);
}

/// The same where the fault came about: not before `after`, and at `fault` at the latest.
pub(crate) fn body_halts_about(trial: &mut Trial, observer: &Observer, after: Time, fault: Time) {
    let closed = body_closes(observer, after).map(|at| at.max(fault));
    let bound = trial.limits.stale + trial.limits.period;
    trial.halted(fault, closed, bound, observer);
}

/// Waits for the daemon to halt for `cause`: it tells when the gate in its motor unit closed.
fn halts(trial: &mut Trial, daemon: &Player, cause: &str, fault: Time, bound: Span, observer: &Observer) {
    let since = || closed_for(daemon, cause, fault);
    // A halt that does not come is missed, not an error.
    let _ = wait_for("the gate closes", || since().is_some());
    trial.halted(fault, since(), bound, observer);
    trial.outcome.expect(since().is_some(), || {
        format!("the fault came at {}, it said {:?}", fault.0, daemon.said())
    });
    // A status is a tenth of a second old: nobody is to take an earlier one for the end of this halt.
    let _ = wait_for("the status shows the halt", || !trial.stage.is_free(CREATURE));
}

/// When the gate in the motor unit closed for `cause` after `fault`, by the daemon's word.
fn closed_for(daemon: &Player, cause: &str, fault: Time) -> Option<Time> {
    let prefix = format!("halt {cause}: ");
    let said = daemon.said();
    let mut times = said
        .iter()
        .filter_map(|l| l.strip_prefix(&prefix)?.parse().ok().map(Time));
    times.find(|at| *at >= fault)
}
