//! The daemon's end of a body process: finds it by name, again whenever it was lost.
//!
//! ```text
//!   call ─► hello ─► map its page ─► hand the readers to the motor unit ─► ask how it looks, ten times a second
//!    ▲                                                                        │ connection ends
//!    └──────── look again ten times a second ◄── empty readers: body lost ◄───┘
//! ```
//! Must never be needed for a halt: the motor unit sees a body's pulse stop by itself.

use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::body::{Answer, Ask, BODY_LINE_MAX, Contract, body_socket};
use ipc::control::{Connection, Peer, Versions, timed_out};
use ipc::wire::Page;
use ipc::wiring::Declaration;
use serde_json::Value;

use super::handover::Giver;
use super::link::{SensorReaders, sensor_readers, world_cells};
use crate::running::Shared;

/// How often a lost body is looked for, and an attached one asked how it looks.
const LOOK: Duration = Duration::from_millis(100);

/// A body in another process.
#[derive(Debug)]
pub struct Remote {
    /// Its name.
    pub name: String,
    /// What the creature expects it to be.
    pub declaration: &'static Declaration,
    /// The cell of the daemon's page in which its first command is.
    pub first: usize,
    /// Hands readers to the motor unit.
    pub giver: Giver<SensorReaders>,
}

/// Keeps looking for the body, and at it, until told to leave.
///
/// # Errors
/// When the host refuses the thread.
pub fn keep(
    remote: Remote,
    shared: Arc<Shared>,
    view: Arc<Mutex<Value>>,
    leave: Arc<AtomicBool>,
) -> std::io::Result<JoinHandle<()>> {
    let mut finder = Finder {
        remote,
        shared,
        view,
        leave,
        said: String::new(),
    };
    std::thread::Builder::new().name("body".into()).spawn(move || {
        while !finder.leave.load(Ordering::Relaxed) {
            finder.attend();
            finder.remote.giver.sweep();
            std::thread::sleep(LOOK);
        }
    })
}

struct Finder {
    remote: Remote,
    shared: Arc<Shared>,
    view: Arc<Mutex<Value>>,
    leave: Arc<AtomicBool>,
    /// What was last said about why there is no body: said once.
    said: String,
}

impl Finder {
    /// Calls the body once, and stays with it for as long as it lives.
    fn attend(&mut self) {
        let name = self.remote.name.clone();
        let (mut connection, pid) = match self.attach() {
            Ok(attached) => attached,
            Err(why) => {
                if why != self.said {
                    let text = format!("no body {name:?}: {why}");
                    self.shared.events.note("body", None, text);
                    self.said = why;
                }
                return;
            }
        };
        self.said.clear();
        let text = format!("body {name} (pid {pid}) attached");
        self.shared.events.note("body", None, text);
        self.look_on(&mut connection);
        let nothing = Page::in_memory(world_cells(self.remote.declaration));
        if let Some(readers) = sensor_readers(self.remote.declaration, &nothing, 0) {
            let _ = self.remote.giver.give(readers);
        }
        if !self.leave.load(Ordering::Relaxed) {
            let text = format!("body {name} (pid {pid}) is gone");
            self.shared.events.note("body", None, text);
            self.shared.domain.clean();
        }
    }

    fn attach(&mut self) -> Result<(Connection, u32), String> {
        let path = body_socket(&self.remote.name);
        let stream = UnixStream::connect(&path)
            .map_err(|e| format!("no answer at {} ({e}); start `subsumed-body`", path.display()))?;
        let io = |e: std::io::Error| format!("its connection failed: {e}");
        let peer = Peer::of(&stream).map_err(io)?;
        if !peer.is_us() {
            return Err(format!("{} is held by user {}", path.display(), peer.user));
        }
        stream.set_read_timeout(Some(LOOK)).map_err(io)?;
        stream.set_write_timeout(Some(LOOK)).map_err(io)?;
        let connection = Connection::over(stream).map_err(io)?;
        let mut connection = connection.with_lines_up_to(BODY_LINE_MAX);
        let hello = Ask::Hello {
            versions: Versions::ours(),
            creature: self.shared.name.clone(),
            owner: self.shared.name.clone(),
            first: self.remote.first,
            contract: Contract::of(self.remote.declaration),
        };
        connection.send(&hello).map_err(io)?;
        match self.answer(&mut connection).map_err(io)? {
            Some(Answer::Welcome {
                owner, pid, floor, ..
            }) => {
                let page = self.shared.domain.map(&owner).map_err(|e| e.to_string())?;
                let readers = sensor_readers(self.remote.declaration, &page, 0)
                    .ok_or_else(|| format!("the page of {owner} has too few cells"))?;
                let given = self.remote.giver.give(readers);
                given.map_err(|_| "the motor unit does not beat".to_string())?;
                self.shared.set_floor(floor);
                Ok((connection, pid))
            }
            Some(Answer::Refused { reasons }) => Err(format!("refused: {}", reasons.join("; "))),
            Some(other) => Err(format!("it answered {other:?} to a greeting")),
            None => Err("it closed the connection".into()),
        }
    }

    /// Waits for an answer, however long a frozen body takes: calling it again would not help it.
    fn answer(&self, connection: &mut Connection) -> std::io::Result<Option<Answer>> {
        loop {
            match connection.receive::<Answer>() {
                Err(e) if timed_out(&e) && !self.leave.load(Ordering::Relaxed) => {}
                other => return other,
            }
        }
    }

    /// Shows how it looks until it is gone.
    fn look_on(&mut self, connection: &mut Connection) {
        while !self.leave.load(Ordering::Relaxed) {
            if connection.send(&Ask::View).is_err() {
                return;
            }
            let Ok(Some(Answer::View { view })) = self.answer(connection) else {
                return;
            };
            *self.view.lock().expect("nobody panics holding the view") = view;
            self.remote.giver.sweep();
            std::thread::sleep(LOOK);
        }
    }
}
