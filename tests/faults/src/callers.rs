//! Callers: somebody says hello to the daemon every millisecond, and waits for no answer.
//!
//! Must never be waited for by who looks whether the daemon lives: a process of several threads that needs a larger table
//! of file descriptors waits for all processors to let go of the old one (Linux, `expand_fdtable`, `synchronize_rcu`),
//! 10 ms as a rule and most of a second beside others that compute. A daemon at its end may keep callers waiting, too.

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::control::{Connection, Request, Versions};

/// Callers that come on a thread of their own until this is dropped; none leaves before.
#[derive(Debug)]
pub(crate) struct Callers {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Callers {
    /// Those who call at `socket`.
    pub(crate) fn of(socket: PathBuf) -> Callers {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let thread = std::thread::spawn(move || {
            let mut callers = Vec::new();
            while !stopped.load(Ordering::Relaxed) {
                callers.extend(greeting(&socket));
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        Callers {
            stop,
            thread: Some(thread),
        }
    }
}

impl Drop for Callers {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A caller that has said hello, and waits for no answer.
pub(crate) fn greeting(socket: &Path) -> std::io::Result<Connection> {
    let stream = UnixStream::connect(socket)?;
    stream.set_read_timeout(Some(Duration::from_millis(1)))?;
    let mut connection = Connection::over(stream)?;
    connection.send(&Request::Hello {
        versions: Versions::ours(),
        program: "faults".into(),
    })?;
    Ok(connection)
}
