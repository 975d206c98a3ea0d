//! Faults of layer processes and callers: none of them may halt the body, or take anything from level 0.
//!
//! Must never leave a rogue behind: it is killed with its trial.

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use ipc::control::{REQUEST_MAX, Reply, Request};
use rustix::process::Signal;
use serde_json::Value;
use stage::{Stage, wait_for};

use crate::rogue::Behaviour;
use crate::trial::{CREATURE, Trial};

/// Level 1 of Allen dies by `signal`.
pub(crate) fn dies(trial: &mut Trial, signal: Signal) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut wander = trial.wander()?;
        trial.wait_a_while();
        wander.end_by(signal)?;
        trial.told(&["layer wander", "died"])
    })
}

/// Level 1 of Allen freezes; it goes on when it thaws.
pub(crate) fn freezes(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut wander = trial.wander()?;
        trial.wait_a_while();
        wander.signal(Signal::STOP);
        std::thread::sleep(Duration::from_millis(400));
        wander.signal(Signal::CONT);
        wander.leave()
    })
}

/// A rogue that ends by itself, in a way that is no good order.
pub(crate) fn ends(trial: &mut Trial, how: Behaviour) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut rogue = trial.rogue(how, how.name())?;
        rogue.says("attached", 1)?;
        let status = rogue.end()?;
        trial
            .outcome
            .expect(!status.success(), || format!("the rogue ended with {status}"));
        trial.told(&[&format!("layer {}", how.name()), "died"])
    })
}

/// A layer that announces 20 ms and writes every 200: its tap runs out in between.
pub(crate) fn slow(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut rogue = trial.rogue(Behaviour::Slow, "slow")?;
        wait_for("its tap holds", || tap_of(&trial.stage, "slow")["holds"] == true)?;
        rogue.signal(Signal::KILL);
        rogue.end()?;
        trial.told(&["layer slow", "died"])?;
        // Gone with its layer; nothing of it holds any longer.
        wait_for("its tap is gone", || tap_of(&trial.stage, "slow").is_null())
    })
}

/// A layer that floods its tap is let go.
pub(crate) fn floods(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        // Let go, a layer is not let in again for a while: another name each time.
        let name = format!("flood{}", trial.outcome.injections);
        let mut rogue = trial.rogue(Behaviour::Flood, &name)?;
        rogue.says("let go", 1)?;
        rogue.end()?;
        trial.told(&[&format!("policy breach: layer {name} floods")])
    })
}

/// A layer whose messages are none: every one is counted, none is delivered.
pub(crate) fn garbage(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut rogue = trial.rogue(Behaviour::Garbage, "garbage")?;
        rogue.says("attached", 1)?;
        wait_for("garbage is counted", || {
            tap_of(&trial.stage, "garbage")["faults"].as_u64() > Some(5)
        })?;
        let delivered = tap_of(&trial.stage, "garbage")["delivered"].as_u64();
        trial.outcome.expect(delivered == Some(0), || {
            format!("{delivered:?} messages were delivered")
        });
        trial.told(&["layer garbage", "messages that were none"])?;
        rogue.leave()
    })
}

/// A layer that writes random bytes over its own shared memory, which the daemon reads: wrong sequence numbers,
/// torn messages, stamps of all times.
pub(crate) fn scribbles(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let name = format!("scribble{}", trial.outcome.injections);
        let mut rogue = trial.rogue(Behaviour::Scribble, &name)?;
        rogue.says("attached", 1)?;
        std::thread::sleep(Duration::from_millis(400));
        rogue.end_by(Signal::KILL)?;
        // It died, or was let go before: wrong numbers look like a flood.
        trial.told(&[&format!("layer {name} (pid"), "its taps run out"])
    })
}

/// Eight processes that attach and detach in a tight loop.
pub(crate) fn churn(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut rogues = Vec::new();
        for number in 0..8 {
            rogues.push(trial.rogue(Behaviour::Churn, &format!("churn{number}"))?);
        }
        std::thread::sleep(Duration::from_millis(700));
        let mut attached = 0;
        for rogue in &mut rogues {
            rogue.leave()?;
            rogue.says("attached", 1)?;
            attached += rogue.number_after("attached ").unwrap_or(0);
        }
        trial.outcome.expect(attached > 16, || {
            format!("they were attached {attached} times only")
        });
        let layers = || {
            trial.stage.status(CREATURE)["layers"]
                .as_array()
                .map_or(0, Vec::len)
        };
        let gone = || {
            let status = trial.stage.status(CREATURE);
            let layers = status["layers"].as_array();
            layers.is_some_and(|l| l.iter().all(|l| l["attached"] == false))
        };
        wait_for(&format!("the last of {} is gone", layers()), gone)
    })
}

/// What is no manifest on the control socket: random bytes, a line without an end, half a document, absurd numbers,
/// depth, and more callers than there are places who never say a word and never go.
pub(crate) fn manifest_garbage(trial: &mut Trial) -> Result<(), String> {
    trial.goes_on(|trial| {
        let mut silent = Vec::new();
        for round in 0..100 {
            let Ok(mut stream) = UnixStream::connect(trial.stage.socket(CREATURE)) else {
                continue;
            };
            let _ = stream.set_write_timeout(Some(Duration::from_millis(200)));
            let _ = stream.set_read_timeout(Some(Duration::from_millis(20)));
            let said = nonsense(trial, round);
            // Refused half-way is as it should be; whatever it answers is no matter.
            if said.is_empty() || stream.write_all(&said).is_err() || said.last() != Some(&b'\n') {
                silent.push(stream);
            } else {
                let _ = stream.read(&mut [0; 256]);
            }
        }
        let answered = matches!(
            trial.stage.ask(CREATURE, &Request::Status),
            Some(Reply::Status(_))
        );
        trial
            .outcome
            .expect(answered, || "nobody answers a tool any more".into());
        drop(silent);
        trial.wait_until_answered()?;
        trial.wander()?.leave()
    })
}

/// What the caller of this round says; most of them nothing.
fn nonsense(trial: &mut Trial, round: usize) -> Vec<u8> {
    match round {
        0..4 => (0..512).map(|_| trial.draw() as u8).chain([b'\n']).collect(),
        4..6 => vec![b' '; 2 * REQUEST_MAX],
        6..10 => br#"{"ask":"plug","layer":"half","level":"#.to_vec(),
        10..14 => br#"{"ask":"plug","layer":["x"],"level":1e999,"taps":-1}
"#
        .to_vec(),
        14..18 => [vec![b'['; 100_000], vec![b'\n']].concat(),
        _ => Vec::new(),
    }
}

/// The tap of layer `name` as the status shows it; null if there is none.
fn tap_of(stage: &Stage, name: &str) -> Value {
    let status = stage.status(CREATURE);
    let from = format!("{name}.heading");
    let mut taps = status["taps"].as_array().into_iter().flatten();
    taps.find(|t| t["from"] == from.as_str())
        .cloned()
        .unwrap_or(Value::Null)
}
