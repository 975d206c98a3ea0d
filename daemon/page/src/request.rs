//! Reading one request, with an end to its size and an end to its time.
//!
//! Never holds more than [`HEAD_BYTES_MAX`] of it and never waits more often than [`READS_MAX`]
//! times, each no longer than [`WAIT_MAX`]; no clock is read for that.

use std::io::{self, Read};
use std::net::TcpStream;
use std::time::Duration;

/// The most bytes that a request line and its headers may have; browsers stay under two thousand.
pub(crate) const HEAD_BYTES_MAX: usize = 8 * 1024;

/// The most bytes that a body may have; the buttons send none.
pub(crate) const BODY_BYTES_MAX: usize = 1024;

/// The most headers of one request; browsers send about fifteen.
const HEADERS_MAX: usize = 64;

/// The longest that one piece of a request, or room for one piece of an answer, is waited for.
pub(crate) const WAIT_MAX: Duration = Duration::from_millis(500);

/// The most pieces that a request may come in; a browser sends one.
const READS_MAX: usize = 16;

/// What this server wants to know of a request.
#[derive(Debug)]
pub(crate) struct Head {
    /// `GET`, `POST`, or something else.
    pub(crate) method: String,
    /// The path without its query.
    pub(crate) path: String,
    /// What follows the path's question mark; empty if nothing does.
    pub(crate) query: String,
    /// The `Authorization` header.
    pub(crate) authorization: Option<String>,
    /// The `Host` header.
    pub(crate) host: Option<String>,
    /// The `Origin` header.
    pub(crate) origin: Option<String>,
    /// The `Sec-Fetch-Site` header.
    pub(crate) fetch_site: Option<String>,
    /// How long the body is said to be.
    pub(crate) body_bytes: usize,
}

/// Why there is no request to answer.
#[derive(Debug)]
pub(crate) enum Unread {
    /// Nothing more came, or too late: hang up without a word.
    Gone,
    /// Not a request that this server takes.
    Malformed(&'static str),
    /// More than [`HEAD_BYTES_MAX`] of headers.
    HeadTooLarge,
    /// More than [`BODY_BYTES_MAX`] of body.
    BodyTooLarge,
}

/// Reads one request from `stream`, body included; the body is dropped.
pub(crate) fn read(stream: &mut TcpStream) -> Result<Head, Unread> {
    stream
        .set_read_timeout(Some(WAIT_MAX))
        .map_err(|_| Unread::Gone)?;
    let mut reads = READS_MAX;
    let mut bytes = [0_u8; HEAD_BYTES_MAX];
    let mut filled = 0;
    let (head, head_bytes) = loop {
        let Some(free) = bytes.get_mut(filled..).filter(|free| !free.is_empty()) else {
            return Err(Unread::HeadTooLarge);
        };
        filled += read_some(stream, free, &mut reads)?;
        if let Some(parsed) = parse(bytes.get(..filled).unwrap_or_default())? {
            break parsed;
        }
    };
    if head.body_bytes > BODY_BYTES_MAX {
        return Err(Unread::BodyTooLarge);
    }
    let mut missing = head.body_bytes.saturating_sub(filled.saturating_sub(head_bytes));
    while missing > 0 {
        let room = missing.min(bytes.len());
        let Some(free) = bytes.get_mut(..room) else { break };
        missing = missing.saturating_sub(read_some(stream, free, &mut reads)?);
    }
    Ok(head)
}

/// Reads at least one byte, if a read is left.
fn read_some(stream: &mut TcpStream, into: &mut [u8], reads: &mut usize) -> Result<usize, Unread> {
    while *reads > 0 {
        *reads -= 1;
        match stream.read(into) {
            Ok(0) => return Err(Unread::Gone),
            Ok(count) => return Ok(count),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return Err(Unread::Gone),
        }
    }
    Err(Unread::Gone)
}

/// The head in `bytes` and its length, or nothing while it is incomplete.
fn parse(bytes: &[u8]) -> Result<Option<(Head, usize)>, Unread> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS_MAX];
    let mut request = httparse::Request::new(&mut headers);
    let length = match request.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Unread::HeadTooLarge),
        Err(_) => return Err(Unread::Malformed("this is not an HTTP request")),
    };
    let path = request.path.unwrap_or("/");
    let mut head = Head {
        method: request.method.unwrap_or_default().to_owned(),
        path: path.split('?').next().unwrap_or(path).to_owned(),
        query: path.split_once('?').map_or("", |(_, query)| query).to_owned(),
        authorization: None,
        host: None,
        origin: None,
        fetch_site: None,
        body_bytes: 0,
    };
    for header in request.headers.iter() {
        let value = String::from_utf8_lossy(header.value).trim().to_owned();
        if header.name.eq_ignore_ascii_case("host") {
            once(&mut head.host, value)?;
        } else if header.name.eq_ignore_ascii_case("authorization") {
            once(&mut head.authorization, value)?;
        } else if header.name.eq_ignore_ascii_case("origin") {
            once(&mut head.origin, value)?;
        } else if header.name.eq_ignore_ascii_case("sec-fetch-site") {
            once(&mut head.fetch_site, value)?;
        } else if header.name.eq_ignore_ascii_case("content-length") {
            // A number too long to read is certainly too large.
            let digits = !value.is_empty() && value.bytes().all(|byte| byte.is_ascii_digit());
            head.body_bytes = match value.parse() {
                Ok(count) if digits => count,
                Err(_) if digits => usize::MAX,
                _ => return Err(Unread::Malformed("the Content-Length is not a number")),
            };
        } else if header.name.eq_ignore_ascii_case("transfer-encoding") {
            return Err(Unread::Malformed("send a Content-Length, no Transfer-Encoding"));
        }
    }
    Ok(Some((head, length)))
}

/// Sets a header that may come only once: two of them could be read in two ways.
fn once(slot: &mut Option<String>, value: String) -> Result<(), Unread> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(Unread::Malformed("a header came twice")),
    }
}
