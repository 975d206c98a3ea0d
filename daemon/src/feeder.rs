//! The feeder: tells systemd and a hardware watchdog that all is well, for as long as the watchdog says so.
//!
//! ```text
//!   watchdog thread (real-time): progress + 1 with every look that finds all vital threads in time
//!   feeder (ordinary thread):    progress moved since the last meal? ──► WATCHDOG=1, one byte to the device
//!                                did not move                         ──► nothing; somebody else restarts us
//! ```
//! So the meals need both: real-time threads that beat, and a host on which ordinary threads still run.
//! systemd also hears from here when the creature is ready (every thread has beaten, and the watchdog has found
//! them in time since), how it is, and when it stops.
//!
//! An emergency stop, a reflex or a lost body is no reason to starve: starting again would not mend it.
//!
//! Must never feed on its own account, nor send the device its farewell (`V`, "magic close") unless the body
//! was brought to a halt in good order.

use std::fs::File;
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sd_notify::NotifyState;

use crate::executor::gauge::BeatGauge;
use crate::executor::host;
use crate::gate::Causes;
use crate::running::Shared;

/// Longest time between two meals; shorter if systemd wants more than four of them in its own time.
const MEAL: Duration = Duration::from_millis(100);

/// Looks of the watchdog, all threads having beaten, until the creature counts as ready.
const READY_LOOKS: u64 = 3;

/// Who is fed.
#[derive(Debug, Default)]
pub struct Fed {
    /// A hardware watchdog, open: from now on it must be fed.
    device: Option<File>,
}

impl Fed {
    /// Opens the device, if there is one. It starts to count at once.
    ///
    /// # Errors
    /// When it cannot be opened for writing; a creature that asks for one does not run without.
    pub fn open(device: Option<&Path>) -> io::Result<Fed> {
        let Some(path) = device else {
            return Ok(Fed::default());
        };
        // Without waiting, should it be a pipe that nobody reads.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let opened = File::options().write(true).custom_flags(nonblocking).open(path);
        let device = opened.map_err(|e| {
            let path = path.display();
            io::Error::new(
                e.kind(),
                format!("the watchdog device {path} cannot be written: {e}"),
            )
        })?;
        Ok(Fed { device: Some(device) })
    }

    fn meal(&mut self) -> io::Result<()> {
        self.device
            .as_mut()
            .map_or(Ok(()), |device| device.write_all(b"."))
    }

    /// Sets the device at rest: the body stands.
    fn farewell(&mut self) -> io::Result<()> {
        self.device
            .as_mut()
            .map_or(Ok(()), |device| device.write_all(b"V"))
    }
}

/// What the feeder goes by.
#[derive(Debug)]
pub struct Tended {
    /// The watchdog's progress; none for a creature without a body, which has no watchdog.
    pub progress: Option<Arc<AtomicU64>>,
    /// Of every real-time thread's members.
    pub beats: Vec<Arc<BeatGauge>>,
    /// "real time" or "best effort".
    pub mode: &'static str,
}

impl Tended {
    /// What moves while all is well. Without a watchdog it moves while anything beats at all.
    fn progress(&self) -> u64 {
        let beats = || self.beats.iter().map(|gauge| gauge.counts().beats).sum();
        self.progress
            .as_ref()
            .map_or_else(beats, |progress| progress.load(Ordering::Relaxed))
    }

    fn all_have_beaten(&self) -> bool {
        self.beats.iter().all(|gauge| gauge.counts().beats > 0)
    }

    /// In one line: up to which level, and whether the body may move. A reflex is everyday life and not said.
    fn status(&self, shared: &Shared) -> String {
        let own = shared.creature.layers.iter().map(|l| (l.level, l.name.clone()));
        let attached = shared.plugs.attached();
        let attached = attached.iter().map(|a| (a.plug.level, a.plug.layer.clone()));
        let mut layers: Vec<(u8, String)> = own.chain(attached).collect();
        layers.sort();
        let level = layers.last().map_or(0, |(level, _)| *level);
        let names: Vec<String> = layers.into_iter().map(|(_, name)| name).collect();
        let halt = match shared.halt.decided().0.without(Causes::REFLEX) {
            Causes::NONE => "may move".to_string(),
            causes => format!("halted: {}", causes.names().join(", ")),
        };
        format!("level {level} ({}); {halt}; {}", names.join(", "), self.mode)
    }
}

/// Whom systemd hears; without it (no NOTIFY_SOCKET) nothing is said to nobody.
#[derive(Debug, Default)]
struct Herald {
    ready: bool,
    status: String,
}

impl Herald {
    /// Says what is new, all in one message: that the creature is ready, that it is well, how it is.
    fn tell(&mut self, ready: bool, well: bool, status: String) {
        if !self.ready && !ready {
            return;
        }
        let mut news = Vec::new();
        if !std::mem::replace(&mut self.ready, true) {
            news.push(NotifyState::Ready);
        }
        if well {
            news.push(NotifyState::Watchdog);
        }
        if status != self.status {
            news.push(NotifyState::Status(&status));
        }
        if !news.is_empty() {
            let _ = sd_notify::notify(&news);
        }
        self.status = status;
    }
}

/// Tells systemd that the body is being halted, and the daemon leaves then.
pub fn stopping() {
    let _ = sd_notify::notify(&[NotifyState::Stopping]);
}

/// Tells systemd that the creature file is being read again.
pub fn reloading() {
    let mut news = vec![NotifyState::Reloading];
    news.extend(NotifyState::monotonic_usec_now());
    let _ = sd_notify::notify(&news);
}

/// Tells systemd that it was.
pub fn reloaded() {
    let _ = sd_notify::notify(&[NotifyState::Ready]);
}

/// Feeds until told to leave.
///
/// # Errors
/// When the host refuses the thread.
pub fn feed(
    mut fed: Fed,
    tended: Tended,
    shared: Arc<Shared>,
    leave: Arc<AtomicBool>,
) -> io::Result<JoinHandle<()>> {
    let wanted = sd_notify::watchdog_enabled();
    let meal = wanted.map_or(MEAL, |wanted| (wanted / 4).min(MEAL));
    std::thread::Builder::new().name("feeder".into()).spawn(move || {
        host::come_first();
        let (mut eaten, mut hungry) = (0, None::<Instant>);
        let (mut beaten_at, mut herald) = (None::<u64>, Herald::default());
        let mut said = String::new();
        while !leave.load(Ordering::Relaxed) {
            let moved = tended.progress();
            if beaten_at.is_none() && tended.all_have_beaten() {
                beaten_at = Some(moved);
            }
            let ready = beaten_at.is_some_and(|at| moved >= at + READY_LOOKS);
            herald.tell(ready, moved != eaten, tended.status(&shared));
            if moved == eaten {
                // Said once; a single look between two beats of a slow watchdog is not worth a word.
                let since = *hungry.get_or_insert_with(Instant::now);
                if since.elapsed() > Duration::from_millis(500) && said.is_empty() {
                    said = "not fed: a vital thread is late".into();
                    shared.events.note("watchdog", None, said.clone());
                }
            } else {
                if !said.is_empty() {
                    shared.events.note("watchdog", None, "fed again");
                    said.clear();
                }
                (eaten, hungry) = (moved, None);
                if let Err(e) = fed.meal() {
                    let text = format!("the watchdog device cannot be fed: {e}");
                    if text != said {
                        shared.events.note("watchdog", None, text.clone());
                        said = text;
                    }
                }
            }
            std::thread::sleep(meal);
        }
        let stands = NotifyState::Status("the body stands; leaving");
        let _ = sd_notify::notify(&[NotifyState::Stopping, stands]);
        if shared.halt.decided().0.has(Causes::SHUTDOWN) {
            let _ = fed.farewell();
        }
    })
}
