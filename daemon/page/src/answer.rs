//! One answer, and how it is written: whole, bounded in time, and the connection closed after it.

use std::borrow::Cow;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

use crate::request::WAIT_MAX;

/// The most pieces that an answer may leave in; on loopback a large one leaves in three or four.
const WRITES_MAX: usize = 64;

/// The most pieces read and dropped after an answer, so that the other side can read it.
const LINGER_READS_MAX: usize = 64;

/// The longest that each of them is waited for.
const LINGER_WAIT_MAX: Duration = Duration::from_millis(100);

/// What goes back to a browser.
pub(crate) struct Answer {
    /// Number and phrase of the status line.
    pub(crate) status: &'static str,
    /// The media type of the text.
    pub(crate) media: &'static str,
    /// The text.
    pub(crate) text: Cow<'static, str>,
}

impl Answer {
    /// A JSON text.
    pub(crate) fn json(text: String) -> Self {
        Self {
            status: "200 OK",
            media: "application/json",
            text: text.into(),
        }
    }

    /// A refusal: `{"error": why}`.
    pub(crate) fn refusal(status: &'static str, why: &str) -> Self {
        let text = format!("{{\"error\":{}}}", quoted(why));
        Self {
            status,
            media: "application/json",
            text: text.into(),
        }
    }

    /// Writes the answer and closes the connection.
    pub(crate) fn send(&self, stream: &mut TcpStream) -> io::Result<()> {
        stream.set_write_timeout(Some(WAIT_MAX))?;
        let head = format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
             Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n\
             Content-Security-Policy: default-src 'self'; base-uri 'none'; form-action 'none'; \
             frame-ancestors 'none'\r\n\r\n",
            self.status,
            self.media,
            self.text.len(),
        );
        write_whole(stream, head.as_bytes())?;
        write_whole(stream, self.text.as_bytes())?;
        stream.shutdown(Shutdown::Write)?;
        linger(stream);
        Ok(())
    }
}

/// Writes all of `bytes`, or fails when the other side stops reading.
fn write_whole(stream: &mut TcpStream, bytes: &[u8]) -> io::Result<()> {
    let mut rest = bytes;
    for _ in 0..WRITES_MAX {
        match stream.write(rest) {
            Ok(count) => rest = rest.get(count..).unwrap_or_default(),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        if rest.is_empty() {
            return Ok(());
        }
    }
    Err(io::ErrorKind::TimedOut.into())
}

/// Reads what the other side still sends, for a moment: closing on unread bytes would cut off the
/// answer on its way.
fn linger(stream: &mut TcpStream) {
    let mut bytes = [0_u8; 4096];
    if stream.set_read_timeout(Some(LINGER_WAIT_MAX)).is_err() {
        return;
    }
    for _ in 0..LINGER_READS_MAX {
        match stream.read(&mut bytes) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
    }
}

/// `text` as a JSON string.
fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for letter in text.chars() {
        match letter {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            control if control < ' ' => out.push_str(&format!("\\u{:04x}", control as u32)),
            other => out.push(other),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn refusals_stay_json() {
        assert_eq!(quoted("a \"b\" \\ \n\u{1} ü"), r#""a \"b\" \\ \n\u0001 ü""#);
    }
}
