//! The callers on the control socket: who holds a place, and who makes room when there is none.
//!
//! Must never take the place of a layer that is attached.

use std::io;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use ipc::clock::Time;

/// Most callers at once: as many layers as may attach (32), and as many tools.
pub const CALLERS_MAX: usize = 64;

/// One caller.
#[derive(Debug)]
pub struct Caller {
    /// Its number.
    pub number: u64,
    /// When it last spoke, in nanoseconds.
    spoke: AtomicU64,
    /// Whether it is an attached layer.
    stays: AtomicBool,
    /// Whether it is sent a recording.
    records: AtomicBool,
    socket: UnixStream,
}

impl Caller {
    /// It spoke at `now`.
    pub fn speaks(&self, now: Time) {
        self.spoke.store(now.0, Ordering::Relaxed);
    }

    /// When it last spoke; when it came, if it never did.
    pub fn last_spoke(&self) -> Time {
        Time(self.spoke.load(Ordering::Relaxed))
    }

    /// It is an attached layer from now on.
    pub fn stays(&self) {
        self.stays.store(true, Ordering::Relaxed);
    }

    /// It is sent a recording from now on.
    pub fn records(&self) {
        self.records.store(true, Ordering::Relaxed);
    }

    /// Closes its connection. A recording is told to end first: its thread closes when all of it is written.
    fn send_away(&self) {
        let directions = if self.records.load(Ordering::Relaxed) {
            Shutdown::Read
        } else {
            Shutdown::Both
        };
        let _ = self.socket.shutdown(directions);
    }
}

/// All callers.
#[derive(Debug, Default)]
pub struct Callers {
    held: Mutex<(u64, Vec<Arc<Caller>>)>,
}

impl Callers {
    fn lock(&self) -> MutexGuard<'_, (u64, Vec<Arc<Caller>>)> {
        self.held.lock().expect("nobody panics holding the callers")
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.lock().1.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One more.
    ///
    /// # Errors
    /// When the host has no file descriptor left.
    pub fn enter(&self, stream: &UnixStream, now: Time) -> io::Result<Arc<Caller>> {
        let socket = stream.try_clone()?;
        let mut held = self.lock();
        held.0 += 1;
        let caller = Arc::new(Caller {
            number: held.0,
            spoke: AtomicU64::new(now.0),
            stays: AtomicBool::new(false),
            records: AtomicBool::new(false),
            socket,
        });
        held.1.push(caller.clone());
        Ok(caller)
    }

    /// One less.
    pub fn leave(&self, number: u64) {
        self.lock().1.retain(|c| c.number != number);
    }

    /// Closes the connection of whoever was silent for longest at `now` and is no layer.
    pub fn make_room(&self, now: Time) {
        let held = self.lock();
        let silence = |c: &&Arc<Caller>| now.since(c.last_spoke());
        let movable = held.1.iter().filter(|c| !c.stays.load(Ordering::Relaxed));
        if let Some(caller) = movable.max_by_key(silence) {
            caller.send_away();
        }
    }

    /// Closes every connection.
    pub fn send_away(&self) {
        for caller in &self.lock().1 {
            caller.send_away();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn the_longest_silent_makes_room_but_never_a_layer() {
        let callers = Callers::default();
        let mut ends = Vec::new();
        for n in 0..3 {
            let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
            theirs.set_nonblocking(true).expect("a socket takes that");
            let caller = callers.enter(&ours, Time(n)).expect("there are descriptors");
            if n == 0 {
                caller.stays();
            }
            ends.push((caller, ours, theirs));
        }
        ends[1].0.speaks(Time(50));
        callers.make_room(Time(100));
        let open = ends.iter_mut().map(|(_, _, theirs)| {
            theirs
                .read(&mut [0])
                .is_err_and(|e| e.kind() == io::ErrorKind::WouldBlock)
        });
        assert_eq!(open.collect::<Vec<_>>(), [true, true, false]);
    }
}
