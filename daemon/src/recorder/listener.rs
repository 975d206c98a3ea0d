//! A listener: writes what the recorder tells into a file or a socket, until it is told to end.
//!
//! Must never keep more than a bounded number of items waiting: what it cannot write in time is lost, and counted.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use ipc::clock::Span;
use recording::{Item, Ring, Writer};

use super::{Begin, KEPT, Recorder};
use crate::gate::Causes;
use crate::running::Shared;

/// How long a ring goes on after the halt that it is kept for.
pub(super) const AFTER_HALT: Duration = Duration::from_secs(1);

/// How often what was written is handed over, so that a recording cut off lacks little.
const FLUSH: Duration = Duration::from_secs(1);

/// What is to be recorded.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// What comes first.
    pub begin: Begin,
    /// How long; none until told to end.
    pub length: Option<Duration>,
    /// Keep only the newest stretch of it, and end with the next halt.
    pub ring: Option<Span>,
}

/// Records into `out` until it is told to `end`, its time is over, or the daemon leaves.
///
/// # Errors
/// When `out` takes no more.
pub fn record(
    recorder: &Recorder,
    wanted: Wanted,
    out: impl Write,
    end: &AtomicBool,
) -> mcap::McapResult<u64> {
    let (first, items) = recorder.listen(wanted.begin);
    let mut writer = Writer::new(out, &recorder.manifest)?;
    let mut ring = wanted
        .ring
        .map(|span| Ring::new(&recorder.manifest, span, super::ring_bytes()));
    let (began, mut flushed) = (Instant::now(), Instant::now());
    let mut halted: Option<Instant> = None;
    let mut last_causes = Causes::NONE;
    let take = |item: Item, ring: &mut Option<Ring>, writer: &mut Writer<_>| match ring {
        Some(ring) => {
            ring.push(item);
            Ok(())
        }
        None => writer.write(&item),
    };
    for item in first {
        take(item, &mut ring, &mut writer)?;
    }
    loop {
        let over = wanted.length.is_some_and(|length| began.elapsed() >= length);
        let kept = halted.is_some_and(|at| at.elapsed() >= AFTER_HALT);
        if over || kept || end.load(Ordering::Relaxed) {
            break;
        }
        match items.next(Duration::from_millis(20)) {
            Ok(item) => {
                if wanted.ring.is_some() && halted.is_none() {
                    let causes = causes_of(&item).unwrap_or(last_causes);
                    if causes.without(last_causes).has(KEPT) && !causes.has(Causes::START) {
                        halted = Some(Instant::now());
                    }
                    last_causes = causes;
                }
                take(item, &mut ring, &mut writer)?;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if ring.is_none() && flushed.elapsed() >= FLUSH {
            writer.flush()?;
            flushed = Instant::now();
        }
    }
    for item in ring.iter().flat_map(Ring::snapshot) {
        writer.write(&item)?;
    }
    writer.finish()
}

/// The causes that a beat of the motor unit noted.
fn causes_of(item: &Item) -> Option<Causes> {
    let Item::Beat { words, .. } = item else {
        return None;
    };
    let entries = afsm::trace::decode(words).entries;
    entries.into_iter().find_map(|entry| match entry {
        afsm::trace::Entry::Causes(bits) => Some(Causes(bits)),
        _ => None,
    })
}

/// Records everything into the file at `path`, from the first beat on, on a thread of its own.
///
/// # Errors
/// When the file cannot be made.
pub fn into_file(shared: Arc<Shared>, path: &Path) -> std::io::Result<JoinHandle<()>> {
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let shown = path.display().to_string();
    std::thread::Builder::new()
        .name("recording".into())
        .spawn(move || {
            let wanted = Wanted {
                begin: Begin::Now,
                length: None,
                ring: None,
            };
            match record(&shared.recorder, wanted, file, &AtomicBool::new(false)) {
                Ok(0) => {}
                Ok(lost) => eprintln!("{shown}: {lost} messages were lost"),
                Err(e) => eprintln!("{shown}: the recording broke off: {e}"),
            }
        })
}
