//! Recording a running creature: the daemon sends an MCAP file over its socket, this program writes it down.
//!
//! Must never take part in the daemon's timing: a disk that is slow costs items of the recording, which are counted.

use std::io::{Read, Write};
use std::net::Shutdown;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use ipc::clock::Span;
use ipc::control::{Reply, Request};
use recording::{Recording, reader};
use serde_json::json;

use crate::live::call;

/// What `subsumectl record` was told.
pub(crate) struct Wanted {
    pub(crate) seconds: Option<f64>,
    pub(crate) ring: Option<Span>,
    pub(crate) past: bool,
}

/// Records into `path` until Ctrl-C, or as `wanted` says.
pub(crate) fn record(creature: &str, path: &Path, as_json: bool, wanted: &Wanted) -> Result<(), String> {
    let shown = path.display();
    // Before the file: without a daemon, what is there already stays.
    drop(call(creature)?);
    let file = std::fs::File::create(path).map_err(|e| format!("{shown}: cannot be written: {e}"))?;
    let leave = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, leave.clone()).map_err(|e| format!("signal {signal}: {e}"))?;
    }
    let bytes = receive(creature, wanted, &leave, std::io::BufWriter::new(file), |e| {
        format!("{shown}: cannot be written: {e}")
    })?;
    let recording = recording::read(path)?;
    let messages: usize = recording.wires.values().map(Vec::len).sum();
    let lost: u64 = recording.losses.values().sum();
    let seconds = recording.span().seconds();
    if as_json {
        let report = json!({
            "file": path, "bytes": bytes, "seconds": seconds, "messages": messages, "lost": lost,
            "losses": recording.losses, "whole": recording.whole,
        });
        println!("{report}");
    } else {
        println!(
            "{shown}: {seconds:.1} s, {messages} messages on {} wires, {lost} lost",
            recording.wires.len()
        );
        for (what, n) in &recording.losses {
            println!("  {what}: {n} lost");
        }
    }
    if recording.whole {
        Ok(())
    } else {
        Err(format!("{shown}: the recording was cut off: the daemon has gone"))
    }
}

/// What the flight recorder holds now; what every register holds if it is off.
pub(crate) fn past(creature: &str) -> Result<Recording, String> {
    let wanted = Wanted {
        seconds: Some(0.0),
        ring: None,
        past: true,
    };
    let mut bytes = Vec::new();
    receive(creature, &wanted, &Arc::default(), &mut bytes, |e| e.to_string())?;
    reader::parse(&bytes).map_err(|e| format!("what the daemon recorded {e}"))
}

/// Receives a recording; `leave` ends it.
fn receive(
    creature: &str,
    wanted: &Wanted,
    leave: &Arc<AtomicBool>,
    mut out: impl Write,
    cannot_write: impl Fn(std::io::Error) -> String,
) -> Result<u64, String> {
    let gone = |e| format!("the daemon does not answer: {e}");
    let mut connection = call(creature)?;
    let request = Request::Record {
        past: wanted.past,
        seconds: wanted.seconds,
        ring: wanted.ring,
    };
    match connection.ask(&request).map_err(gone)? {
        Reply::Recording => {}
        Reply::Refused { reasons } => return Err(reasons.join("; ")),
        other => return Err(format!("the daemon answered {other:?}")),
    }
    let socket = connection.socket().try_clone().map_err(gone)?;
    socket
        .set_read_timeout(Some(std::time::Duration::from_millis(100)))
        .map_err(gone)?;
    let mut rest = connection.rest();
    let (mut bytes, mut told) = (0, false);
    let mut buffer = vec![0; 1 << 16];
    loop {
        if leave.load(Ordering::Relaxed) && !told {
            // The daemon ends the file and closes its own direction.
            let _ = socket.shutdown(Shutdown::Write);
            told = true;
        }
        match rest.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => {
                out.write_all(&buffer[..n]).map_err(&cannot_write)?;
                bytes += n as u64;
            }
            Err(e)
                if matches!(
                    e.kind(),
                    std::io::ErrorKind::WouldBlock | std::io::ErrorKind::Interrupted
                ) => {}
            Err(e) => return Err(gone(e)),
        }
    }
    out.flush().map_err(&cannot_write)?;
    Ok(bytes)
}
