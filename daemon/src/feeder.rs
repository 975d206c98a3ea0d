//! The feeder: tells systemd and a hardware watchdog that all is well, for as long as the watchdog says so.
//!
//! ```text
//!   watchdog thread (real-time): progress + 1 with every look that finds all vital threads in time
//!   feeder (ordinary thread):    progress moved since the last meal? ──► WATCHDOG=1, one byte to the device
//!                                did not move                         ──► nothing; somebody else restarts us
//! ```
//! So the meals need both: real-time threads that beat, and a host on which ordinary threads still run.
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

use crate::gate::Causes;
use crate::running::Shared;

/// Longest time between two meals; shorter if systemd wants more than four of them in its own time.
const MEAL: Duration = Duration::from_millis(100);

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
        // Whoever does not listen is not there: without NOTIFY_SOCKET this does nothing.
        let _ = sd_notify::notify(&[NotifyState::Watchdog]);
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

/// Feeds until told to leave.
///
/// # Errors
/// When the host refuses the thread.
pub fn feed(
    mut fed: Fed,
    progress: Arc<AtomicU64>,
    shared: Arc<Shared>,
    leave: Arc<AtomicBool>,
) -> io::Result<JoinHandle<()>> {
    let wanted = sd_notify::watchdog_enabled();
    let meal = wanted.map_or(MEAL, |wanted| (wanted / 4).min(MEAL));
    std::thread::Builder::new().name("feeder".into()).spawn(move || {
        let _ = sd_notify::notify(&[NotifyState::Ready]);
        let (mut eaten, mut hungry) = (0, None::<Instant>);
        let mut said = String::new();
        while !leave.load(Ordering::Relaxed) {
            let moved = progress.load(Ordering::Relaxed);
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
        let _ = sd_notify::notify(&[NotifyState::Stopping]);
        if shared.halt.decided().0.has(Causes::SHUTDOWN) {
            let _ = fed.farewell();
        }
    })
}
