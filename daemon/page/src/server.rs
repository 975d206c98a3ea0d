//! The server: a listening socket and a few threads that answer from it.
//!
//! Threads are counted and small because the daemon locks its memory; each takes one connection,
//! answers one request and closes it, so that an idle browser holds none of them for long.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::error::ServeError;
use crate::{Source, Token, request, routes};

/// How many requests are answered at once: a browser opens at most six connections to one server.
const WORKERS_MAX: usize = 6;

/// The stack of a worker: a request of 8 KiB and what a [`Source`] needs to write its texts.
const WORKER_STACK_BYTES: usize = 512 * 1024;

/// How long a worker rests when the system has no connection to give (out of file descriptors).
const ACCEPT_REST: Duration = Duration::from_millis(50);

/// The page, being served. Dropping it stops it.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    stopping: Arc<AtomicBool>,
    workers: Vec<JoinHandle<()>>,
}

/// Serves the page to this machine on `address` (port 0 takes any free one) until the [`Server`] is stopped.
///
/// Its threads inherit the scheduling of the caller: call this from a thread that is not real-time.
///
/// # Errors
/// When the address is not loopback, is taken, or the system gives no socket or threads.
pub fn serve(address: SocketAddr, source: Arc<dyn Source>) -> Result<Server, ServeError> {
    if !address.ip().is_loopback() {
        return Err(ServeError::NotLoopback { address });
    }
    open(address, None, source)
}

/// The same, on any address and also to other machines: who is not on this one has to send `token` with whatever
/// tells of the creature or halts it. Neither that nor the answers are encrypted.
///
/// # Errors
/// When the address is taken, or the system gives no socket or threads.
pub fn serve_others(
    address: SocketAddr,
    token: Token,
    source: Arc<dyn Source>,
) -> Result<Server, ServeError> {
    open(address, Some(token), source)
}

fn open(address: SocketAddr, token: Option<Token>, source: Arc<dyn Source>) -> Result<Server, ServeError> {
    let listener = TcpListener::bind(address).map_err(|source| match source.kind() {
        io::ErrorKind::AddrInUse => ServeError::PortTaken { address },
        _ => ServeError::Listen { address, source },
    })?;
    let bound = listener
        .local_addr()
        .map_err(|source| ServeError::Listen { address, source })?;
    let listener = Arc::new(listener);
    let token = Arc::new(token);
    let mut server = Server {
        address: bound,
        stopping: Arc::new(AtomicBool::new(false)),
        workers: Vec::with_capacity(WORKERS_MAX),
    };
    for index in 0..WORKERS_MAX {
        let (listener, source) = (Arc::clone(&listener), Arc::clone(&source));
        let (stopping, token) = (Arc::clone(&server.stopping), Arc::clone(&token));
        let worker = thread::Builder::new()
            .name(format!("page-{index}"))
            .stack_size(WORKER_STACK_BYTES)
            .spawn(move || work(&listener, token.as_ref().as_ref(), source.as_ref(), &stopping))
            .map_err(|source| ServeError::Thread { source })?;
        server.workers.push(worker);
    }
    Ok(server)
}

impl Server {
    /// Where the page is, with the port that was really taken.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Stops serving and waits until every thread is gone. Requests under way are answered first.
    pub fn stop(mut self) {
        self.join();
    }

    /// Where this process reaches it: an address that means all of them is none to connect to.
    fn door(&self) -> SocketAddr {
        match self.address.ip() {
            ip if !ip.is_unspecified() => self.address,
            IpAddr::V4(_) => (Ipv4Addr::LOCALHOST, self.address.port()).into(),
            IpAddr::V6(_) => (Ipv6Addr::LOCALHOST, self.address.port()).into(),
        }
    }

    fn join(&mut self) {
        // Relaxed is enough: the flag guards no data, and every worker is woken until it saw it.
        self.stopping.store(true, Ordering::Relaxed);
        while self.workers.iter().any(|worker| !worker.is_finished()) {
            // A connection is what a worker waits for.
            let woken = TcpStream::connect_timeout(&self.door(), Duration::from_millis(50));
            drop(woken);
            thread::sleep(Duration::from_millis(1));
        }
        for worker in self.workers.drain(..) {
            // A worker that panicked has nothing left to stop.
            let _ = worker.join();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.join();
    }
}

/// What a worker does until the server stops.
fn work(listener: &TcpListener, token: Option<&Token>, source: &dyn Source, stopping: &AtomicBool) {
    while !stopping.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((stream, from)) if !stopping.load(Ordering::Relaxed) => {
                serve_one(stream, from.ip(), token, source);
            }
            Ok(_) => {}
            Err(_) => thread::sleep(ACCEPT_REST),
        }
    }
}

/// Answers the one request of a connection.
fn serve_one(mut stream: TcpStream, from: IpAddr, token: Option<&Token>, source: &dyn Source) {
    let asked = request::read(&mut stream);
    let answer = match asked {
        Ok(head) => Some(routes::answer(&head, from, token, source)),
        Err(unread) => routes::answer_unread(&unread),
    };
    if let Some(answer) = answer {
        // A browser that went away meanwhile is no fault of the daemon.
        let _ = answer.send(&mut stream);
    }
}
