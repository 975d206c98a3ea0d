//! The control socket: answers tools and layer processes.
//!
//! Must never let a caller make the daemon allocate without bound or wait for long: lines, connections and
//! silences are bounded, and every caller has a thread of its own.

use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::clock::Span;
use ipc::control::{Connection, Reply, Request, Versions, run_dir, socket_path};

use crate::gate::Causes;
use crate::recorder::Begin;
use crate::recorder::listener::{self, Wanted};
use crate::running::Shared;

/// Most callers at once: as many layers as may attach, and as many tools.
const CALLERS_MAX: usize = 64;

/// How long a caller may be silent, unless it is a layer.
const SILENCE: Duration = Duration::from_secs(30);

/// The socket, and the thread that answers.
pub struct Control {
    path: PathBuf,
    leave: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Control {
    /// Opens the socket of `name` and answers on it.
    ///
    /// # Errors
    /// [`io::ErrorKind::AddrInUse`] when a daemon of that name answers; otherwise what the host refused.
    pub fn open(name: &str, shared: Arc<Shared>) -> io::Result<Control> {
        let path = socket_path(name);
        claim(name)?;
        std::fs::create_dir_all(run_dir())?;
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path)?;
        // The same user only.
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600))?;
        listener.set_nonblocking(true)?;
        let leave = Arc::new(AtomicBool::new(false));
        let leaving = leave.clone();
        let thread = std::thread::Builder::new()
            .name("control".into())
            .spawn(move || accept(&listener, &shared, &leaving))?;
        Ok(Control {
            path,
            leave,
            thread: Some(thread),
        })
    }
}

/// Whether the name is free.
///
/// # Errors
/// [`io::ErrorKind::AddrInUse`] when a daemon of that name answers.
pub fn claim(name: &str) -> io::Result<()> {
    let path = socket_path(name);
    match UnixStream::connect(&path) {
        Ok(_) => Err(io::Error::new(
            io::ErrorKind::AddrInUse,
            format!(
                "a daemon runs {name:?} already (it answers at {}); stop it, or choose another --name",
                path.display()
            ),
        )),
        Err(_) => Ok(()),
    }
}

impl Drop for Control {
    fn drop(&mut self) {
        self.leave.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        let _ = std::fs::remove_file(&self.path);
        // Only if it is empty and ours; somebody else's socket may be in it.
        let _ = std::fs::remove_dir(run_dir());
    }
}

fn accept(listener: &UnixListener, shared: &Arc<Shared>, leaving: &AtomicBool) {
    let callers = Arc::new(AtomicUsize::new(0));
    while !leaving.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((stream, _)) => {
                if callers.load(Ordering::Relaxed) >= CALLERS_MAX {
                    continue;
                }
                callers.fetch_add(1, Ordering::Relaxed);
                let (shared, counted) = (shared.clone(), callers.clone());
                let answer = move || {
                    let _ = stream.set_nonblocking(false);
                    let _ = answer_all(stream, &shared);
                    counted.fetch_sub(1, Ordering::Relaxed);
                };
                if std::thread::Builder::new()
                    .name("caller".into())
                    .stack_size(256 << 10)
                    .spawn(answer)
                    .is_err()
                {
                    callers.fetch_sub(1, Ordering::Relaxed);
                }
            }
            Err(_) => std::thread::sleep(Duration::from_millis(10)),
        }
    }
}

fn answer_all(stream: UnixStream, shared: &Shared) -> io::Result<()> {
    stream.set_read_timeout(Some(SILENCE))?;
    stream.set_write_timeout(Some(SILENCE))?;
    let mut connection = Connection::over(stream)?;
    let mut plugged = None;
    let ended = converse(&mut connection, shared, &mut plugged);
    if let Some(number) = plugged {
        let why = if matches!(ended, Ok(Farewell::Said)) {
            "detached"
        } else {
            "died"
        };
        shared.plugs.detach(number, why);
    }
    ended.map(drop)
}

/// How a caller left.
enum Farewell {
    /// It said so.
    Said,
    /// Its connection closed.
    None,
}

fn converse(connection: &mut Connection, shared: &Shared, plugged: &mut Option<u32>) -> io::Result<Farewell> {
    let mut greeted = false;
    loop {
        let request = match connection.receive::<Request>() {
            Ok(Some(request)) => request,
            Ok(None) => return Ok(Farewell::None),
            Err(e) if e.kind() == io::ErrorKind::InvalidData => {
                let reasons = vec![format!("not a request: {e}")];
                connection.send(&Reply::Refused { reasons })?;
                return Err(e);
            }
            Err(e) => return Err(e),
        };
        let reply = match request {
            Request::Hello { versions, program } => {
                greeted = versions == Versions::ours();
                greet(&versions, &program, shared)
            }
            _ if !greeted => Reply::Refused {
                reasons: vec!["say hello first".into()],
            },
            Request::Plug(_) if plugged.is_some() => Reply::Refused {
                reasons: vec!["one layer a connection".into()],
            },
            Request::Plug(plug) => match shared.plugs.attach(plug, &shared.domain) {
                Ok(number) => {
                    *plugged = Some(number);
                    // A layer speaks with its wires from now on; the socket only tells that it lives.
                    connection.socket().set_read_timeout(None)?;
                    Reply::Plugged { plug: number }
                }
                Err(reasons) => Reply::Refused { reasons },
            },
            Request::Unplug => return Ok(Farewell::Said),
            Request::Record { past, seconds, ring } => {
                connection.send(&Reply::Recording)?;
                record(connection, shared, past, seconds, ring)?;
                return Ok(Farewell::Said);
            }
            other => answer(other, shared),
        };
        connection.send(&reply)?;
    }
}

/// Records into the connection until the caller closes its direction of it.
fn record(
    connection: &Connection,
    shared: &Shared,
    past: bool,
    seconds: Option<f64>,
    ring: Option<Span>,
) -> io::Result<()> {
    let socket = connection.socket().try_clone()?;
    let end = Arc::new(AtomicBool::new(false));
    let (mut other_end, told) = (socket.try_clone()?, end.clone());
    other_end.set_read_timeout(None)?;
    let listen = move || {
        let mut byte = [0];
        while matches!(io::Read::read(&mut other_end, &mut byte), Ok(1..)) {}
        told.store(true, Ordering::Relaxed);
    };
    let ear = std::thread::Builder::new()
        .name("ear".into())
        .stack_size(64 << 10)
        .spawn(listen)?;
    let wanted = Wanted {
        begin: if past { Begin::Past } else { Begin::Now },
        length: seconds.and_then(|s| Duration::try_from_secs_f64(s).ok()),
        ring,
    };
    let recorded = listener::record(&shared.recorder, wanted, io::BufWriter::new(&socket), &end);
    let _ = socket.shutdown(std::net::Shutdown::Both);
    let _ = ear.join();
    recorded.map(drop).map_err(io::Error::other)
}

fn greet(theirs: &Versions, program: &str, shared: &Shared) -> Reply {
    let ours = Versions::ours();
    if *theirs == ours {
        return Reply::Welcome {
            versions: ours,
            creature: shared.name.clone(),
        };
    }
    let reason =
        format!("{program} was built for {theirs}; this daemon for {ours}: build both from one version");
    shared
        .events
        .note("layer", Some(program), format!("refused: {reason}"));
    Reply::Refused {
        reasons: vec![reason],
    }
}

fn answer(request: Request, shared: &Shared) -> Reply {
    match request {
        Request::Status => Reply::Status(shared.status()),
        Request::Directory => Reply::Directory(shared.plugs.directory()),
        Request::Events { after } => Reply::Events(shared.events.after(after)),
        Request::Halt => {
            shared.halt.halt(Causes::EMERGENCY);
            shared
                .events
                .note("halt", None, "emergency stop from the control socket");
            Reply::Done
        }
        Request::Reset => match shared.halt.reset() {
            Ok(()) => {
                shared.events.note("halt", None, "reset from the control socket");
                Reply::Done
            }
            Err(reason) => Reply::Refused {
                reasons: vec![reason],
            },
        },
        Request::Hello { .. } | Request::Plug(_) | Request::Unplug | Request::Record { .. } => {
            Reply::Refused {
                reasons: vec!["not now".into()],
            }
        }
    }
}
