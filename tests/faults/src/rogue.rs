//! The rogue: a layer process that shares one wire, taps `turn.heading` with it, and misbehaves as told.
//!
//! Must never outlive its time, nor come in by another way than any layer does.

use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::ValueEnum;
use ipc::clock::{self, Span, Time};
use ipc::control::{Connection, Plug, PlugTap, Reply, Request, Versions, socket_path, timed_out};
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::Writer;
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wiring::creature::How;
use ipc::wiring::directory::Listed;

use crate::stage::CREATURE;

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
            Behaviour::Churn => "churn",
            Behaviour::Panic => "panic",
            Behaviour::Exit => "exit",
        }
    }
}

/// Misbehaves as layer `name` until it is let go, SIGTERM, or for `seconds`.
///
/// # Errors
/// When it is not let in at all.
pub(crate) fn run(how: Behaviour, name: &str, seconds: f64) -> Result<(), String> {
    let leave = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGTERM, leave.clone())
        .map_err(|e| format!("SIGTERM: {e}"))?;
    let end = clock::monotonic() + Span::from_seconds(seconds).unwrap_or(Span::ZERO);
    let domain = Domain::join(name).map_err(|e| e.to_string())?;
    let owner = format!("{CREATURE}/{name}");
    let owned = domain.own(&owner, 1).map_err(|e| e.to_string())?;
    let writer = owned
        .page()
        .writer(0, Kind::Polar)
        .ok_or("the page has no cell")?;
    let goes_on = || !leave.load(Ordering::Relaxed) && clock::monotonic() < end;
    if how == Behaviour::Churn {
        churn(&owned, name, &owner, goes_on);
    } else {
        let connection = attach(&owned, name, &owner)?;
        eprintln!("attached");
        misbehave(how, writer, connection, &owned, goes_on);
    }
    drop(owned);
    domain.leave();
    Ok(())
}

/// Comes and goes.
fn churn(owned: &OwnedPage, name: &str, owner: &str, goes_on: impl Fn() -> bool) {
    let (mut attached, mut refused) = (0_u64, 0_u64);
    while goes_on() {
        match attach(owned, name, owner) {
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
fn attach(owned: &OwnedPage, name: &str, owner: &str) -> Result<Connection, String> {
    let stream = UnixStream::connect(socket_path(CREATURE)).map_err(|e| e.to_string())?;
    let io = |e: std::io::Error| e.to_string();
    let mut connection = Connection::over(stream).map_err(io)?;
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: "rogue".into(),
    };
    connection.ask(&hello).map_err(io)?;
    let port = format!("{name}.heading");
    let plug = Plug {
        layer: name.into(),
        level: 1,
        period: PERIOD,
        pid: std::process::id(),
        owner: owner.into(),
        outputs: vec![Listed {
            name: port.clone(),
            kind: Kind::Polar,
            unit: String::new(),
            level: Some(1),
            owner: owner.into(),
            index: 0,
            plug: 0,
        }],
        inputs: Vec::new(),
        open_taps: Vec::new(),
        open_reads: None,
        neighbours: Vec::new(),
        modules: Vec::new(),
        wires: Vec::new(),
        taps: vec![PlugTap {
            how: How::Suppress,
            from: port,
            to: "turn.heading".into(),
            time_constant: TAU,
        }],
    };
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
