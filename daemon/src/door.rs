//! The door of the control socket: lets callers in, each to a thread of its own, as long as there is room.
//!
//! Must never take for a caller what the daemon itself cannot do without: a place of an attached layer, or the last of
//! its address space.

use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock;

use crate::admission::Admission;
use crate::callers::{CALLERS_MAX, Callers};
use crate::control;
use crate::executor::host;
use crate::running::Shared;

/// Address space that callers must leave, in bytes, where it is limited: what recorder, watcher and events take in
/// minutes. None of them can be refused memory and go on.
const RESERVE: u64 = 8 << 20;

/// Stack of a caller's thread, in bytes.
const STACK: usize = 512 << 10;

/// Where callers come in, and who answers them.
pub(crate) struct Door {
    pub(crate) listener: UnixListener,
    pub(crate) shared: Arc<Shared>,
    pub(crate) admission: Admission,
    pub(crate) callers: Arc<Callers>,
    pub(crate) leave: Arc<AtomicBool>,
}

impl Door {
    /// Lets callers in until it is time to leave.
    pub(crate) fn attend(&self) {
        while !self.leave.load(Ordering::Relaxed) {
            match self.listener.accept() {
                Ok((stream, _)) => self.let_in(stream),
                Err(_) => std::thread::sleep(Duration::from_millis(10)),
            }
        }
    }

    fn let_in(&self, stream: UnixStream) {
        if host::address_space_left().is_some_and(|left| left < RESERVE) {
            // What is left is the daemon's own: a piece of memory that it cannot do without would end it.
            return;
        }
        if self.callers.len() >= CALLERS_MAX {
            self.callers.make_room(clock::monotonic());
            // Its thread leaves within a blink, or a few on a busy host; should it not, this caller has to come again.
            for _ in 0..500 {
                if self.callers.len() < CALLERS_MAX {
                    break;
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            if self.callers.len() >= CALLERS_MAX {
                return;
            }
        }
        let Ok(caller) = self.callers.enter(&stream, clock::monotonic()) else {
            return;
        };
        let (shared, admission, callers) =
            (self.shared.clone(), self.admission.clone(), self.callers.clone());
        let number = caller.number;
        let answer = move || {
            let _ = control::answer_all(stream, &caller, &shared, &admission);
            drop(shared);
            callers.leave(caller.number);
        };
        let builder = std::thread::Builder::new().name("caller".into());
        if builder.stack_size(STACK).spawn(answer).is_err() {
            self.callers.leave(number);
        }
    }
}
