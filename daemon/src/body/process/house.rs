//! The body's side of the conversation with a daemon that wants to drive it.
//!
//! Must never let two drive at once, nor anybody who is not its own user.

use std::io;
use std::os::unix::net::UnixStream;
use std::sync::atomic::Ordering;
use std::time::Duration;

use ipc::body::{Answer, Ask, BODY_LINE_MAX, Contract, owner_of};
use ipc::control::{Connection, Peer, Versions};
use ipc::wire::Page;
use serde_json::Value;

use super::{CommandReaders, HELLO_WAIT, House, command_readers};

impl House {
    pub(super) fn receive(&self, stream: UnixStream) -> io::Result<()> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(HELLO_WAIT))?;
        stream.set_write_timeout(Some(HELLO_WAIT))?;
        let peer = Peer::of(&stream)?;
        let mut connection = Connection::over(stream)?.with_lines_up_to(BODY_LINE_MAX);
        if !peer.is_us() {
            let reasons = vec![format!("user {} may not drive this body", peer.user)];
            return connection.send(&Answer::Refused { reasons });
        }
        let Some(hello) = connection.receive::<Ask>()? else {
            return Ok(());
        };
        match self.admit(hello) {
            Err(reasons) => {
                eprintln!("body {}: refused: {}", self.name, reasons.join("; "));
                connection.send(&Answer::Refused { reasons })
            }
            Ok(creature) => {
                eprintln!("body {}: driven by {creature} (pid {})", self.name, peer.pid);
                let ended = self.converse(&mut connection);
                eprintln!("body {}: {creature} (pid {}) left", self.name, peer.pid);
                self.dismiss();
                ended
            }
        }
    }

    /// Lets a daemon drive.
    fn admit(&self, hello: Ask) -> Result<String, Vec<String>> {
        let Ask::Hello {
            versions,
            creature,
            owner,
            first,
            contract,
        } = hello
        else {
            return Err(vec!["say hello first".into()]);
        };
        if versions != Versions::ours() {
            let ours = Versions::ours();
            return Err(vec![format!(
                "the daemon was built for {versions}; this body for {ours}"
            )]);
        }
        if let Some(reason) = Contract::of(self.kind.declaration).against(&contract) {
            return Err(vec![reason]);
        }
        let mut driver = self.driver.lock().expect("nobody panics holding the driver");
        if let Some(other) = driver.as_ref() {
            return Err(vec![format!("{other} drives this body already")]);
        }
        let page = self.domain.map(&owner).map_err(|e| vec![e.to_string()])?;
        let readers = command_readers(self.kind.declaration, &page, first)
            .ok_or_else(|| vec![format!("the page of {owner} has too few cells")])?;
        self.give(readers)?;
        *driver = Some(creature.clone());
        Ok(creature)
    }

    fn give(&self, readers: CommandReaders) -> Result<(), Vec<String>> {
        let mut giver = self.giver.lock().expect("nobody panics holding the giver");
        giver
            .give(readers)
            .map_err(|_| vec!["the body does not beat".into()])
    }

    /// Answers who drives, until it leaves.
    fn converse(&self, connection: &mut Connection) -> io::Result<()> {
        connection.send(&Answer::Welcome {
            owner: owner_of(&self.name),
            period: self.period,
            pid: std::process::id(),
            floor: self.floor.clone(),
        })?;
        // A frozen daemon keeps its place; its commands go stale all the same.
        connection
            .socket()
            .set_read_timeout(Some(Duration::from_millis(500)))?;
        while !self.leave.load(Ordering::Relaxed) {
            match connection.receive::<Ask>() {
                Ok(Some(Ask::View)) => connection.send(&Answer::View { view: self.view() })?,
                Ok(Some(Ask::Hello { .. })) => {
                    let reasons = vec!["one hello a connection".into()];
                    connection.send(&Answer::Refused { reasons })?;
                }
                Ok(None) => return Ok(()),
                Err(e) if ipc::control::timed_out(&e) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(())
    }

    /// How the world looks after its next turn; nothing if it does not turn.
    fn view(&self) -> Value {
        let mut views = self.views.lock().expect("nobody panics holding the views");
        while views.take().is_some() {}
        self.view_wanted.store(true, Ordering::Relaxed);
        for _ in 0..100 {
            if let Some(view) = views.take() {
                return view;
            }
            std::thread::sleep(Duration::from_millis(1).max(Duration::from_nanos(self.period.0 / 10)));
        }
        Value::Null
    }

    /// Nobody drives any more: what is left of the page goes, and the files of a dead daemon.
    fn dismiss(&self) {
        let nothing = Page::in_memory(self.kind.declaration.inputs.len());
        if let Some(readers) = command_readers(self.kind.declaration, &nothing, 0) {
            let _ = self.give(readers);
        }
        *self.driver.lock().expect("nobody panics holding the driver") = None;
        self.domain.clean();
    }
}
