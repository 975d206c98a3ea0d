//! Calling a daemon: where it answers, and why it does not.
//!
//! Must never wait longer than its time-out, nor take a daemon of another version for one that answers.

use std::io;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::Duration;

use super::place::{called, domain_prefix, run_dirs};
use super::{Connection, Reply, Request, Versions, socket_path};

/// Why a daemon could not be called.
#[derive(Debug)]
pub enum CallError {
    /// No daemon of that name runs; `others` do.
    NoDaemon {
        /// The creature asked for.
        creature: String,
        /// The creatures whose daemons have a socket there.
        others: Vec<String>,
    },
    /// It answers, but is built otherwise.
    Version {
        /// The daemon's reasons.
        reasons: Vec<String>,
    },
    /// There is a socket, but not for this user.
    Denied {
        /// Where it is.
        path: PathBuf,
    },
    /// The socket failed.
    Io(io::Error),
}

impl std::fmt::Display for CallError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            CallError::NoDaemon { creature, others } => {
                write!(
                    f,
                    "no daemon runs the creature {creature:?} (no answer at {})",
                    socket_path(creature).display()
                )?;
                match others.as_slice() {
                    [] => write!(f, "; start one with `subsumed`"),
                    some => write!(f, "; running: {}", some.join(", ")),
                }
            }
            CallError::Denied { path } => write!(
                f,
                "the daemon at {} is not open to this user; ask as its own user (`sudo -u subsumed ...`) or as root, \
                 or name this user in [outsiders] of its creature file",
                path.display()
            ),
            CallError::Version { reasons } => f.write_str(&reasons.join("; ")),
            CallError::Io(e) => write!(f, "the control socket failed: {e}"),
        }
    }
}

impl std::error::Error for CallError {}

impl From<io::Error> for CallError {
    fn from(e: io::Error) -> CallError {
        CallError::Io(e)
    }
}

/// Calls the daemon of `creature` as `program`.
///
/// # Errors
/// [`CallError::NoDaemon`] when none runs, [`CallError::Denied`] when it is somebody else's, [`CallError::Version`]
/// when it was built otherwise.
pub fn call(creature: &str, program: &str) -> Result<Connection, CallError> {
    let path = called(creature);
    let stream = UnixStream::connect(&path).map_err(|e| match e.kind() {
        io::ErrorKind::PermissionDenied => CallError::Denied { path },
        _ => CallError::NoDaemon {
            creature: creature.into(),
            others: running(),
        },
    })?;
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    let mut connection = Connection::over(stream)?;
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: program.into(),
    };
    match connection.ask(&hello)? {
        Reply::Welcome { .. } => Ok(connection),
        Reply::Refused { reasons } => Err(CallError::Version { reasons }),
        other => Err(io::Error::other(format!("the daemon answered {other:?} to a greeting")).into()),
    }
}

/// Creatures whose daemon answers.
pub fn running() -> Vec<String> {
    let prefix = domain_prefix();
    let entries = run_dirs()
        .into_iter()
        .filter_map(|dir| std::fs::read_dir(dir).ok());
    let mut names: Vec<String> = entries
        .flatten()
        .flatten()
        .filter(|entry| UnixStream::connect(entry.path()).is_ok())
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            Some(name.strip_prefix(&prefix)?.strip_suffix(".sock")?.to_string())
        })
        .collect();
    names.sort();
    names.dedup();
    names
}
