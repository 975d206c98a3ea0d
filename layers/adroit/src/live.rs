//! Commands to a running hierarchy over a Unix socket: asked in one process, carried out in another between
//! two evaluations.
//!
//! Must never be served on a thread that beats.

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use serde::{Deserialize, Serialize};

use crate::language::Running;

/// Longest request, bytes.
const REQUEST_MAX: u64 = 64 * 1024;
/// Who runs the hierarchy commands it, nobody else.
const OWNER_ONLY: u32 = 0o600;
/// Either side waits this long for the other.
const PATIENCE: Duration = Duration::from_secs(2);

/// Where a running hierarchy takes commands.
#[derive(Args, Clone, Debug)]
pub struct Address {
    /// The socket that `run` was given
    #[arg(long)]
    socket: PathBuf,
}

/// What may be asked of a running hierarchy.
#[derive(Serialize, Deserialize)]
pub enum Request {
    /// Apply one or more statements, all or nothing.
    Apply(String),
    /// Tell what was applied.
    List,
    /// Take back what was applied last.
    Undo,
    /// Tell the program with all that was applied.
    Save,
}

type Answer = Result<String, String>;

impl Address {
    /// Sends a request and prints the answer.
    ///
    /// # Errors
    /// In words: nobody is there, or what was asked cannot be done.
    pub fn ask(&self, request: &Request) -> Result<(), String> {
        let answer = self
            .exchange(request)
            .map_err(|error| format!("{}: {error}", self.socket.display()))?;
        answer.map(|text| print!("{text}"))
    }

    fn exchange(&self, request: &Request) -> io::Result<Answer> {
        let mut stream = UnixStream::connect(&self.socket)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        serde_json::to_writer(&mut stream, request)?;
        stream.write_all(b"\n")?;
        let mut line = String::new();
        BufReader::new(stream).read_line(&mut line)?;
        Ok(serde_json::from_str(&line)?)
    }
}

/// The socket of a running hierarchy; the file is removed when the run ends.
#[derive(Debug)]
pub struct Listener {
    socket: UnixListener,
    path: PathBuf,
}

impl Listener {
    /// Listens at `path`. A socket that a dead process left there is taken away.
    ///
    /// # Errors
    /// In words, when something else is there or nothing can be put there.
    pub fn open(path: &Path) -> Result<Self, String> {
        let open = || {
            let dead = |error: io::Error| error.kind() == io::ErrorKind::ConnectionRefused;
            if UnixStream::connect(path).is_err_and(dead) {
                fs::remove_file(path)?;
            }
            let socket = UnixListener::bind(path)?;
            fs::set_permissions(path, fs::Permissions::from_mode(OWNER_ONLY))?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error: io::Error| format!("{}: {error}", path.display()))?;
        Ok(Self {
            socket,
            path: path.to_owned(),
        })
    }

    /// Carries out what is asked now, if anything is; a peer that says nothing sensible is told so.
    /// `taken_up` is told after each change, before it is answered: where the hierarchy beats elsewhere, that is
    /// where it is handed over.
    pub fn serve(&self, control: &mut Running, mut taken_up: impl FnMut(&mut Running)) {
        while let Ok((stream, _)) = self.socket.accept() {
            if let Err(error) = answer(stream, control, &mut taken_up) {
                eprintln!("{}: {error}", self.path.display());
            }
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        // Nothing can be done about a socket file that will not go.
        let _ = fs::remove_file(&self.path);
    }
}

fn answer(
    mut stream: UnixStream,
    control: &mut Running,
    taken_up: &mut impl FnMut(&mut Running),
) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut line = String::new();
    BufReader::new((&stream).take(REQUEST_MAX)).read_line(&mut line)?;
    let answer = match serde_json::from_str(&line) {
        Ok(request) => carry_out(request, control, taken_up),
        Err(error) => Err(format!("expected a request: {error}")),
    };
    serde_json::to_writer(&mut stream, &answer)?;
    stream.write_all(b"\n")
}

fn carry_out(request: Request, control: &mut Running, taken_up: &mut impl FnMut(&mut Running)) -> Answer {
    match request {
        Request::Apply(command) => {
            control.apply(&command).map_err(|problems| problems.to_string())?;
            taken_up(control);
            Ok(format!(
                "applied after evaluation {}\n",
                control.hierarchy().number()
            ))
        }
        Request::List => {
            let entry = |(number, applied): (usize, &crate::language::Applied)| {
                format!(
                    "{}. after evaluation {}: {}\n",
                    number + 1,
                    applied.after_evaluation,
                    applied.text.trim()
                )
            };
            Ok(control.list().iter().enumerate().map(entry).collect())
        }
        Request::Undo => {
            let undone = control.undo().ok_or("nothing was applied")?;
            taken_up(control);
            Ok(format!("taken back: {}\n", undone.text.trim()))
        }
        Request::Save => Ok(control.text()),
    }
}
