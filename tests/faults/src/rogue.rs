//! The rogue: a layer process that shares one wire, taps `turn.heading` with it, and misbehaves as told.
//!
//! Must never outlive its time, nor come in by another way than any layer does.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::ValueEnum;
use ipc::clock::{self, Span, Time};
use ipc::control::{Connection, Reply, Request, Versions, socket_path, timed_out};
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::Writer;
use ipc::wire::iceoryx::{Domain, OwnedPage};
use stage::announcement;

use crate::draws::Draws;
use crate::trial::CREATURE;

/// The period that it announces.
const PERIOD: Span = Span::millis(20);

/// Time constant of its tap.
pub(crate) const TAU: Span = Span::millis(200);

/// How it misbehaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Behaviour {
    /// It does not.
    Sound,
    /// It writes ten times too slowly.
    Slow,
    /// It writes as fast as it can.
    Flood,
    /// It writes what is no message.
    Garbage,
    /// It writes random bytes over its own shared memory: sequence numbers, stamps, words.
    Scribble,
    /// It comes and goes as fast as it can.
    Churn,
    /// It panics half a second after it was attached.
    Panic,
    /// It leaves half a second after it was attached, without a word.
    Exit,
}

impl Behaviour {
    /// Its name on a command line, and of its layer.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Behaviour::Sound => "sound",
            Behaviour::Slow => "slow",
            Behaviour::Flood => "flood",
            Behaviour::Garbage => "garbage",
            Behaviour::Scribble => "scribble",
            Behaviour::Churn => "churn",
            Behaviour::Panic => "panic",
            Behaviour::Exit => "exit",
        }
    }
}

/// Misbehaves as layer `name` until it is let go, SIGTERM, or for `seconds`; what is random about it comes from
/// `seed`.
///
/// # Errors
/// When it is not let in at all.
pub(crate) fn run(how: Behaviour, name: &str, seconds: f64, seed: u64) -> Result<(), String> {
    let leave = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGTERM, leave.clone())
        .map_err(|e| format!("SIGTERM: {e}"))?;
    let end = clock::monotonic() + Span::from_seconds(seconds).unwrap_or(Span::ZERO);
    let domain = Domain::join(name).map_err(|e| e.to_string())?;
    let owner = format!("{CREATURE}/{name}");
    let others = segments();
    let owned = domain.own(&owner, 1).map_err(|e| e.to_string())?;
    let writer = owned
        .page()
        .writer(0, Kind::Polar)
        .ok_or("the page has no cell")?;
    let goes_on = || !leave.load(Ordering::Relaxed) && clock::monotonic() < end;
    if how == Behaviour::Churn {
        churn(&owned, name, goes_on);
    } else {
        let connection = attach(&owned, name)?;
        eprintln!("attached");
        if how == Behaviour::Scribble {
            return scribble(&others, seed, goes_on);
        }
        misbehave(how, writer, connection, &owned, goes_on);
    }
    drop(owned);
    domain.leave();
    Ok(())
}

/// Comes and goes.
fn churn(owned: &OwnedPage, name: &str, goes_on: impl Fn() -> bool) {
    let (mut attached, mut refused) = (0_u64, 0_u64);
    while goes_on() {
        match attach(owned, name) {
            Ok(mut connection) => {
                attached += 1;
                // Every other time without a word.
                if attached.is_multiple_of(2) {
                    let _ = connection.send(&Request::Unplug);
                }
            }
            Err(_) => refused += 1,
        }
    }
    eprintln!("refused {refused}");
    eprintln!("attached {attached}");
}

/// Writes random bytes over the segment that is not one of `others`.
fn scribble(others: &[PathBuf], seed: u64, goes_on: impl Fn() -> bool) -> Result<(), String> {
    let own = segments().into_iter().find(|s| !others.contains(s));
    let own = own.ok_or("its segment is not found")?;
    let trouble = |e: std::io::Error| format!("{}: {e}", own.display());
    let segment = File::options().write(true).open(&own).map_err(trouble)?;
    let words = segment.metadata().map_err(trouble)?.len() / 8;
    let mut random = Draws(seed);
    while goes_on() {
        for _ in 0..64 {
            let place = 8 * (random.draw() % words.max(1));
            segment
                .write_all_at(&random.draw().to_ne_bytes(), place)
                .map_err(trouble)?;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// The segments of this stage in which wires lie.
fn segments() -> Vec<PathBuf> {
    let mut found = stage::Stage::inherited().map_or(Vec::new(), |s| s.segments());
    found.retain(|s| s.extension().is_some_and(|e| e == "data"));
    found
}

fn misbehave(
    how: Behaviour,
    mut writer: Writer,
    mut connection: Connection,
    owned: &OwnedPage,
    goes_on: impl Fn() -> bool,
) {
    let _ = connection
        .socket()
        .set_read_timeout(Some(Duration::from_millis(1)));
    let began = clock::monotonic();
    let pause = match how {
        Behaviour::Slow => Span(10 * PERIOD.0),
        _ => PERIOD,
    };
    let mut due = began;
    let mut round = 0_usize;
    while goes_on() {
        owned.serve();
        match connection.receive::<Reply>() {
            Err(e) if timed_out(&e) => {}
            _ => {
                eprintln!("let go");
                return;
            }
        }
        let now = clock::monotonic();
        let late = now.since(began) > Span::millis(500);
        match how {
            Behaviour::Flood => {
                for _ in 0..10_000 {
                    writer.write(clock::monotonic(), &[0.5; WORDS_MAX]);
                }
                continue;
            }
            Behaviour::Panic if late => panic!("as told"),
            Behaviour::Exit if late => std::process::exit(3),
            _ => {}
        }
        if now < due {
            continue;
        }
        due = now + pause;
        round += 1;
        let (stamp, value) = match how {
            Behaviour::Garbage => garbage(round, now),
            _ => (now, 0.3),
        };
        writer.write(stamp, &[value; WORDS_MAX]);
    }
    let _ = connection.send(&Request::Unplug);
}

/// What is no message, of every sort in turn.
fn garbage(round: usize, now: Time) -> (Time, f64) {
    match round % 7 {
        0 => (now, f64::NAN),
        1 => (now, f64::INFINITY),
        2 => (now, f64::NEG_INFINITY),
        3 => (now, -f64::NAN),
        4 => (now + Span::secs(3600), 0.3),
        5 => (Time(u64::MAX), 0.3),
        _ => (now + Span::secs(1), f64::from_bits(0x7ff0_dead_beef_0001)),
    }
}

/// Attaches the layer, sharing its page meanwhile.
fn attach(owned: &OwnedPage, name: &str) -> Result<Connection, String> {
    let stream = UnixStream::connect(socket_path(CREATURE)).map_err(|e| e.to_string())?;
    let io = |e: std::io::Error| e.to_string();
    let mut connection = Connection::over(stream).map_err(io)?;
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: "rogue".into(),
    };
    connection.ask(&hello).map_err(io)?;
    let plug = announcement(CREATURE, name, PERIOD, TAU);
    connection.send(&Request::Plug(plug)).map_err(io)?;
    // The daemon maps the page before it answers: somebody has to hand it over.
    connection
        .socket()
        .set_read_timeout(Some(Duration::from_millis(2)))
        .map_err(io)?;
    let answer = loop {
        owned.serve();
        match connection.receive::<Reply>() {
            Err(e) if timed_out(&e) => {}
            other => break other.map_err(io)?,
        }
    };
    match answer {
        Some(Reply::Plugged { .. }) => Ok(connection),
        Some(Reply::Refused { reasons }) => Err(reasons.join("; ")),
        other => Err(format!("a plug was answered with {other:?}")),
    }
}
