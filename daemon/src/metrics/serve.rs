//! Serving metrics: one answer to each request, on a loopback port or a Unix socket.
//!
//! Must never listen to another host, nor wait long for a caller: requests are read within bounds of size and time,
//! one after the other.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::running::Shared;

/// Most bytes of a request's head; Prometheus sends about 300.
const HEAD_BYTES_MAX: usize = 8 << 10;

/// Most headers of a request.
const HEADERS_MAX: usize = 64;

/// How long a caller is waited for, each time.
const WAIT: Duration = Duration::from_millis(500);

/// How often it is looked whether somebody calls.
const LOOK: Duration = Duration::from_millis(20);

const MEDIA: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Where metrics are served.
#[derive(Clone, Debug)]
pub enum Endpoint {
    /// On 127.0.0.1, at this port; 0 for any that is free.
    Port(u16),
    /// On a Unix socket.
    Socket(PathBuf),
}

/// Metrics being served. Dropping it stops that.
pub struct Metrics {
    /// The port, if it is one.
    pub address: Option<SocketAddr>,
    path: Option<PathBuf>,
    leave: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Metrics {
    fn drop(&mut self) {
        self.leave.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        if let Some(path) = &self.path {
            let _ = std::fs::remove_file(path);
        }
    }
}

enum Listener {
    Port(TcpListener),
    Socket(UnixListener),
}

/// Serves the metrics of `shared` at `endpoint`.
///
/// # Errors
/// What the host refused: a port or socket that is taken.
pub fn serve(endpoint: &Endpoint, shared: Arc<Shared>) -> io::Result<Metrics> {
    let (listener, address, path) = match endpoint {
        Endpoint::Port(port) => {
            let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], *port))).map_err(|e| {
                io::Error::new(e.kind(), format!("--metrics-port {port}: {e}; choose another"))
            })?;
            listener.set_nonblocking(true)?;
            let address = listener.local_addr()?;
            (Listener::Port(listener), Some(address), None)
        }
        Endpoint::Socket(path) => {
            let listener = bind(path)
                .map_err(|e| io::Error::new(e.kind(), format!("--metrics-socket {}: {e}", path.display())))?;
            (Listener::Socket(listener), None, Some(path.clone()))
        }
    };
    let leave = Arc::new(AtomicBool::new(false));
    let leaving = leave.clone();
    let thread = std::thread::Builder::new()
        .name("metrics".into())
        .stack_size(256 << 10)
        .spawn(move || listen(&listener, &shared, &leaving))?;
    Ok(Metrics {
        address,
        path,
        leave,
        thread: Some(thread),
    })
}

/// A socket for the same user and group only; a dead one in its place is removed.
fn bind(path: &PathBuf) -> io::Result<UnixListener> {
    use std::os::unix::fs::FileTypeExt;
    let dead = std::os::unix::net::UnixStream::connect(path).is_err();
    if dead && std::fs::symlink_metadata(path).is_ok_and(|m| m.file_type().is_socket()) {
        std::fs::remove_file(path)?;
    }
    let listener = UnixListener::bind(path)?;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o660))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

fn listen(listener: &Listener, shared: &Shared, leave: &AtomicBool) {
    while !leave.load(Ordering::Relaxed) {
        // A caller that hangs up meanwhile is no fault of the daemon.
        let answered = match listener {
            Listener::Port(port) => port.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(false)?;
                stream.set_read_timeout(Some(WAIT))?;
                stream.set_write_timeout(Some(WAIT))?;
                answer(stream, shared)
            }),
            Listener::Socket(socket) => socket.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(false)?;
                stream.set_read_timeout(Some(WAIT))?;
                stream.set_write_timeout(Some(WAIT))?;
                answer(stream, shared)
            }),
        };
        if answered.is_err() {
            std::thread::sleep(LOOK);
        }
    }
}

fn answer(mut stream: impl Read + Write, shared: &Shared) -> io::Result<()> {
    let (status, media, text) = match read(&mut stream)? {
        Some((method, path)) if path == "/metrics" && (method == "GET" || method == "HEAD") => {
            ("200 OK", MEDIA, super::text(&shared.status()))
        }
        Some((_, path)) if path == "/metrics" => ("405 Method Not Allowed", "text/plain", "use GET\n".into()),
        Some(_) => ("404 Not Found", "text/plain", "there is only /metrics\n".into()),
        None => (
            "400 Bad Request",
            "text/plain",
            "this is not an HTTP request\n".into(),
        ),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {media}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{text}",
        text.len()
    )?;
    stream.flush()
}

/// Method and path of a request; none if it is not one.
fn read(stream: &mut impl Read) -> io::Result<Option<(String, String)>> {
    let mut head = [0; HEAD_BYTES_MAX];
    let mut filled = 0;
    while filled < head.len() {
        let n = stream.read(&mut head[filled..])?;
        if n == 0 {
            break;
        }
        filled += n;
        let mut headers = [httparse::EMPTY_HEADER; HEADERS_MAX];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&head[..filled]) {
            Ok(httparse::Status::Complete(_)) => {
                let path = request
                    .path
                    .unwrap_or_default()
                    .split('?')
                    .next()
                    .unwrap_or_default();
                return Ok(Some((request.method.unwrap_or_default().into(), path.into())));
            }
            Ok(httparse::Status::Partial) => {}
            Err(_) => break,
        }
    }
    Ok(None)
}
