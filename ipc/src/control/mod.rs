//! The control channel: how layer processes and tools speak to a running daemon.
//!
//! One JSON document a line over a Unix socket, each at most [`LINE_MAX`] bytes; the caller speaks first and
//! every request has one reply. A layer stays attached for as long as its connection is open.
//!
//! Must never carry wire messages: those go through shared memory.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;

use serde::{Deserialize, Serialize};

use crate::clock::{self, Span, Time};
use crate::wire::LAYOUT;
use crate::wire::iceoryx::ICEORYX2;
use crate::wiring::creature::How;
use crate::wiring::directory::{Directory, Listed};

mod call;
mod peer;
mod place;

pub use call::{CallError, call, running};
pub use peer::Peer;
pub(crate) use place::socket_in_run_dir;
pub use place::{run_dir, socket_path};

/// Version of the control protocol.
pub const PROTOCOL: u32 = 1;

/// Longest line: the directory of a creature of 1,000 modules takes about 400 KiB.
pub const LINE_MAX: usize = 4 << 20;

/// Longest line that a daemon takes: the manifest of a layer of 500 modules takes about 200 KiB.
pub const REQUEST_MAX: usize = 256 << 10;

/// What must be equal at both ends.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// Version of the control protocol.
    pub protocol: u32,
    /// Version of the wire layout.
    pub layout: u32,
    /// Version of iceoryx2.
    pub iceoryx2: String,
}

impl Versions {
    /// Those of this program.
    pub fn ours() -> Versions {
        Versions {
            protocol: PROTOCOL,
            layout: LAYOUT,
            iceoryx2: ICEORYX2.into(),
        }
    }
}

impl std::fmt::Display for Versions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "protocol {}, wire layout {}, iceoryx2 {}",
            self.protocol, self.layout, self.iceoryx2
        )
    }
}

/// What a caller may ask.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "ask")]
pub enum Request {
    /// First on every connection.
    Hello {
        /// The caller's versions.
        versions: Versions,
        /// The caller's name.
        program: String,
    },
    /// The state of everything.
    Status,
    /// The ports there are.
    Directory,
    /// Events after the `after`-th.
    Events {
        /// Number of the last event already seen; 0 for all.
        after: u64,
    },
    /// Emergency stop; holds until reset.
    Halt,
    /// Ends an emergency stop.
    Reset,
    /// Records what happens. The answer is [`Reply::Recording`], followed by the bytes of an MCAP file until the
    /// daemon closes the connection; the caller ends the recording by closing its own direction.
    Record {
        /// Whether to begin with what the flight recorder holds.
        past: bool,
        /// How long to record, in seconds; 0 for what is there already, none until the caller ends it.
        seconds: Option<f64>,
        /// Keep only the newest stretch, until the body halts.
        ring: Option<Span>,
    },
    /// Joins a layer for as long as this connection lasts.
    Plug(Plug),
    /// The joined layer leaves of its own will; no answer is waited for.
    Unplug,
}

/// A layer that wants to join.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plug {
    /// The layer's name.
    pub layer: String,
    /// Its level.
    pub level: u8,
    /// Time between its beats.
    pub period: Span,
    /// Its process.
    pub pid: u32,
    /// Under what name it shares its own wires.
    pub owner: String,
    /// Its own output ports, in the order of its page.
    pub outputs: Vec<Listed>,
    /// Its modules, for pictures.
    pub modules: Vec<PlugModule>,
    /// Wires into its modules, `from` and `to`, for pictures.
    pub wires: Vec<(String, String)>,
    /// Its taps.
    pub taps: Vec<PlugTap>,
}

/// A module of a layer that wants to join.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlugModule {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Names of its inputs.
    pub inputs: Vec<String>,
    /// Names of its outputs.
    pub outputs: Vec<String>,
}

/// A tap of a layer that wants to join.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlugTap {
    /// Which way it acts.
    pub how: How,
    /// The newcomer's output port.
    pub from: String,
    /// The creature's port.
    pub to: String,
    /// Its time constant.
    pub time_constant: Span,
}

/// What the daemon answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "answer", content = "with")]
pub enum Reply {
    /// The caller may go on.
    Welcome {
        /// The daemon's versions.
        versions: Versions,
        /// The creature's name.
        creature: String,
    },
    /// The ports there are.
    Directory(Directory),
    /// The state of everything; see the daemon's `status`.
    Status(serde_json::Value),
    /// Events, oldest first.
    Events(Vec<Event>),
    /// A recording follows, see [`Request::Record`].
    Recording,
    /// Done.
    Done,
    /// The layer is attached.
    Plugged {
        /// Its number.
        plug: u32,
    },
    /// Not done, and why.
    Refused {
        /// The reasons.
        reasons: Vec<String>,
    },
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Its number, counted from 1.
    pub number: u64,
    /// Seconds since the daemon started.
    pub time_s: f64,
    /// What kind of thing: `layer`, `halt`, `overrun`, `daemon`.
    pub kind: String,
    /// The layer it is about, if it is about one.
    pub layer: Option<String>,
    /// What happened, in a sentence.
    pub text: String,
}

/// One end of a control connection.
#[derive(Debug)]
pub struct Connection {
    reader: BufReader<UnixStream>,
    writer: UnixStream,
    line_max: usize,
    /// How long a line may take from its first byte to its end.
    line_time: Option<Span>,
    /// The beginning of a line whose end has not come yet, and when that began.
    begun: Vec<u8>,
    begun_at: Time,
}

impl Connection {
    /// Over an open socket.
    ///
    /// # Errors
    /// When the socket cannot be cloned.
    pub fn over(stream: UnixStream) -> io::Result<Connection> {
        let writer = stream.try_clone()?;
        Ok(Connection {
            reader: BufReader::new(stream),
            writer,
            line_max: LINE_MAX,
            line_time: None,
            begun: Vec::new(),
            begun_at: Time::ZERO,
        })
    }

    /// The same, but lines longer than `bytes` are refused.
    #[must_use]
    pub fn with_lines_up_to(mut self, bytes: usize) -> Connection {
        self.line_max = bytes;
        self
    }

    /// The same, but a line that takes longer than `span` from its first byte to its end is refused, however
    /// steadily its bytes drip in. With a time-out on the socket it is noticed when nothing comes as well.
    #[must_use]
    pub fn with_lines_within(mut self, span: Span) -> Connection {
        self.line_time = Some(span);
        self
    }

    /// Sends one document.
    ///
    /// # Errors
    /// When the other end is gone.
    pub fn send<T: Serialize>(&mut self, document: &T) -> io::Result<()> {
        let mut line = serde_json::to_vec(document).map_err(io::Error::other)?;
        line.push(b'\n');
        self.writer.write_all(&line)
    }

    /// Receives one document; `None` when the other end has closed.
    ///
    /// # Errors
    /// When the line is too long or is not such a document. When the time-out of the socket is reached
    /// ([`timed_out`]) it can be called again: what came so far is kept.
    pub fn receive<T: for<'d> Deserialize<'d>>(&mut self) -> io::Result<Option<T>> {
        loop {
            if self.is_overdue() {
                return Err(invalid("a line without an end"));
            }
            let come = self.reader.fill_buf()?;
            if come.is_empty() && self.begun.is_empty() {
                return Ok(None);
            }
            if self.begun.is_empty() {
                self.begun_at = clock::monotonic();
            }
            let end = come.iter().position(|b| *b == b'\n');
            let taken = end.map_or(come.len(), |end| end + 1);
            if come.is_empty() || self.begun.len() + taken > self.line_max {
                return Err(invalid("half a line, or one too long"));
            }
            self.begun.extend_from_slice(&come[..taken]);
            self.reader.consume(taken);
            if end.is_some() {
                break;
            }
        }
        let line = std::mem::take(&mut self.begun);
        serde_json::from_slice(&line)
            .map(Some)
            .map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))
    }

    /// Asks and waits for the answer.
    ///
    /// # Errors
    /// When the other end is gone or does not understand.
    pub fn ask(&mut self, request: &Request) -> io::Result<Reply> {
        self.send(request)?;
        self.receive()?
            .ok_or_else(|| io::Error::new(io::ErrorKind::UnexpectedEof, "the daemon closed the connection"))
    }

    /// What the daemon sends from here on, after [`Reply::Recording`].
    pub fn rest(self) -> impl Read {
        self.reader
    }

    fn is_overdue(&self) -> bool {
        let limit = self.line_time.filter(|_| !self.begun.is_empty());
        limit.is_some_and(|limit| clock::monotonic().since(self.begun_at) > limit)
    }

    /// The socket itself.
    pub fn socket(&self) -> &UnixStream {
        &self.writer
    }
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Whether a receive only ran into the time-out of its socket.
pub fn timed_out(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
