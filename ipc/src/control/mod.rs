//! The control channel: how layer processes and tools speak to a running daemon.
//!
//! One JSON document a line over a Unix socket, each at most [`LINE_MAX`] bytes; the caller speaks first and
//! every request has one reply, but for those that say that they have none. A layer stays attached for as long
//! as its connection is open, and only it is spoken to unasked, in [`Order`]s:
//!
//! ```text
//!   layer:   hello ─► directory ─► plug ──► (beats) ─────────────► obeyed 1 ─► counts … ─► unplug
//!   daemon:     welcome   directory   plugged ─► order 1: join a tap ─┘
//! ```
//!
//! Must never carry wire messages: those go through shared memory.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;

use serde::{Deserialize, Serialize};

use crate::clock::{self, Span, Time};

mod call;
mod document;
mod peer;
mod place;

pub use call::{CallError, call, running};
pub use document::{Event, JoinTap, Order, Plug, PlugModule, PlugTap, REFUSAL_MAX, Reply, Request, Versions};
pub use peer::Peer;
pub(crate) use place::socket_in_run_dir;
pub use place::{run_dir, socket_path};

/// Version of the control protocol.
pub const PROTOCOL: u32 = 2;

/// Longest line: the directory of a creature of 1,000 modules takes about 400 KiB.
pub const LINE_MAX: usize = 4 << 20;

/// Longest line that a daemon takes: the manifest of a layer of 500 modules takes about 200 KiB.
pub const REQUEST_MAX: usize = 256 << 10;

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

    /// Asks and waits for the answer, through signals and a stop of this process as well.
    ///
    /// # Errors
    /// When the other end is gone or does not understand.
    pub fn ask(&mut self, request: &Request) -> io::Result<Reply> {
        self.send(request)?;
        let answer = loop {
            match self.receive() {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                other => break other?,
            }
        };
        answer.ok_or_else(|| io::Error::new(io::ErrorKind::UnexpectedEof, "the daemon closed the connection"))
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
