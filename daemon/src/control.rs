//! The control socket: answers tools and layer processes.
//!
//! Must never let a caller make the daemon allocate without bound or wait for long: lines, their time,
//! connections and silences are bounded, every caller has a thread of its own, and when all places are
//! taken the one that has been silent for longest makes room. A layer that is attached keeps its place.

use std::io;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::clock::{self, Span};
use ipc::control::{
    Connection, Peer, REQUEST_MAX, Reply, Request, Versions, run_dir, socket_path, timed_out,
};

use crate::admission::Admission;
use crate::callers::{Caller, Callers};
use crate::door::Door;
use crate::gate::Causes;
use crate::plugs::Joined;
use crate::recorder::Begin;
use crate::recorder::listener::{self, Wanted};
use crate::running::Shared;

/// How long a caller may be silent, unless it is a layer.
const SILENCE: Span = Span::secs(30);

/// How long a request may take from its first byte to its end.
const LINE_TIME: Span = Span::secs(2);

/// How long a caller may take to read an answer.
const ANSWER_TIME: Duration = Duration::from_secs(5);

/// How long a caller may take to read the next stretch of a recording.
const RECORD_TIME: Duration = Duration::from_secs(30);

/// How often a caller's thread looks whether it is to end.
const LOOK: Duration = Duration::from_millis(200);

/// How often that of an attached layer looks whether there are orders for it.
const ORDERS_LOOK: Duration = Duration::from_millis(20);

/// The socket, and the thread that answers.
pub struct Control {
    path: PathBuf,
    leave: Arc<AtomicBool>,
    callers: Arc<Callers>,
    thread: Option<JoinHandle<()>>,
}

impl Control {
    /// Opens the socket of `name` and answers those on it whom `admission` admits.
    ///
    /// # Errors
    /// [`io::ErrorKind::AddrInUse`] when a daemon of that name answers; otherwise what the host refused.
    pub fn open(name: &str, shared: Arc<Shared>, admission: Admission) -> io::Result<Control> {
        let path = socket_path(name);
        claim(name)?;
        std::fs::create_dir_all(run_dir())?;
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path)?;
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(admission.socket_mode()))?;
        listener.set_nonblocking(true)?;
        let leave = Arc::new(AtomicBool::new(false));
        let callers = Arc::new(Callers::default());
        let door = Door {
            listener,
            shared,
            admission,
            callers: callers.clone(),
            leave: leave.clone(),
        };
        let thread = std::thread::Builder::new()
            .name("control".into())
            .spawn(move || door.attend())?;
        Ok(Control {
            path,
            leave,
            callers,
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
        // Their threads hold what the daemon wants to take apart.
        self.callers.send_away();
        for _ in 0..100 {
            if self.callers.is_empty() {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let _ = std::fs::remove_file(&self.path);
        // Only if it is empty and ours; somebody else's socket may be in it.
        let _ = std::fs::remove_dir(run_dir());
    }
}

pub(crate) fn answer_all(
    stream: UnixStream,
    caller: &Caller,
    shared: &Shared,
    admission: &Admission,
) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(LOOK))?;
    stream.set_write_timeout(Some(ANSWER_TIME))?;
    let peer = Peer::of(&stream)?;
    let connection = Connection::over(stream)?;
    let mut connection = connection
        .with_lines_up_to(REQUEST_MAX)
        .with_lines_within(LINE_TIME);
    if !admission.admits(peer) {
        let text = format!(
            "user {} (pid {}) was turned away: the creature does not name it",
            peer.user, peer.pid
        );
        shared.events.note("caller", None, text);
        let reasons = vec![format!("user {} may not speak to this creature", peer.user)];
        return connection.send(&Reply::Refused { reasons });
    }
    let mut plugged = None;
    let ended = converse(&mut connection, caller, shared, peer, &mut plugged);
    if let Some(Joined { number, .. }) = plugged {
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
    /// Its connection closed, or was.
    None,
}

fn converse(
    connection: &mut Connection,
    caller: &Caller,
    shared: &Shared,
    peer: Peer,
    plugged: &mut Option<Joined>,
) -> io::Result<Farewell> {
    let mut greeted = false;
    loop {
        if let Some(joined) = plugged {
            if joined.dismissed.load(Ordering::Relaxed) {
                return Ok(Farewell::None);
            }
            while let Some((number, order)) = joined.orders.next() {
                connection.send(&Reply::Order { number, order })?;
            }
        }
        let request = match connection.receive::<Request>() {
            Ok(Some(request)) => request,
            Ok(None) => return Ok(Farewell::None),
            Err(e) if timed_out(&e) => {
                if is_over(caller, plugged.as_ref()) {
                    return Ok(Farewell::None);
                }
                continue;
            }
            Err(e) if e.kind() == io::ErrorKind::InvalidData => {
                let reasons = vec![format!("not a request: {e}")];
                connection.send(&Reply::Refused { reasons })?;
                return Err(e);
            }
            Err(e) => return Err(e),
        };
        caller.speaks(clock::monotonic());
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
            // The process that speaks is the one whose life counts, whatever it says.
            Request::Plug(plug) => {
                let pid = peer.pid.unsigned_abs();
                match shared
                    .plugs
                    .attach(ipc::control::Plug { pid, ..plug }, &shared.domain)
                {
                    Ok(joined) => {
                        let number = joined.number;
                        caller.stays();
                        *plugged = Some(joined);
                        connection.socket().set_read_timeout(Some(ORDERS_LOOK))?;
                        Reply::Plugged { plug: number }
                    }
                    Err(reasons) => Reply::Refused { reasons },
                }
            }
            Request::Unplug => return Ok(Farewell::Said),
            // What an attached layer reports has no answer.
            Request::Obeyed { order, refused } if plugged.is_some() => {
                let joined = plugged.as_ref().expect("it is attached");
                shared.plugs.obeyed(joined.number, order, refused);
                continue;
            }
            Request::Counts { taps } if plugged.is_some() => {
                let joined = plugged.as_ref().expect("it is attached");
                shared.plugs.counted(joined.number, &taps);
                continue;
            }
            Request::Record { past, seconds, ring } => {
                connection.send(&Reply::Recording)?;
                caller.records();
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
    other_end.set_write_timeout(Some(RECORD_TIME))?;
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

/// Whether a caller that says nothing has to go. A layer speaks with its wires; its socket only tells that it
/// lives.
fn is_over(caller: &Caller, plugged: Option<&Joined>) -> bool {
    plugged.is_none() && clock::monotonic().since(caller.last_spoke()) > SILENCE
}

fn greet(theirs: &Versions, program: &str, shared: &Shared) -> Reply {
    let ours = Versions::ours();
    if *theirs == ours {
        return Reply::Welcome {
            versions: ours,
            creature: shared.name.clone(),
        };
    }
    let program: String = program.chars().take(48).collect();
    let reason =
        format!("{program} was built for {theirs}; this daemon for {ours}: build both from one version");
    shared
        .events
        .note("layer", Some(&program), format!("refused: {reason}"));
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
            Err(reason) => {
                let text = format!("reset from the control socket refused: {reason}");
                shared.events.note("halt", None, text);
                Reply::Refused {
                    reasons: vec![reason],
                }
            }
        },
        Request::Hello { .. }
        | Request::Plug(_)
        | Request::Unplug
        | Request::Obeyed { .. }
        | Request::Counts { .. }
        | Request::Record { .. } => Reply::Refused {
            reasons: vec!["not now".into()],
        },
    }
}
