//! The journal: events as entries with fields, when systemd reads what this process says.
//!
//! ```text
//!   stderr is the journal's own stream (JOURNAL_STREAM names it)?   yes ──► one datagram an event, with fields
//!                                                                   no  ──► readable text on stderr
//! ```
//! Fields: `SUBSUMED_KIND` (halt, layer, policy, overrun, watchdog, body, caller, reload, daemon), `SUBSUMED_LAYER`,
//! `SUBSUMED_WIRE` (one for each wire or tapped port that it is about), `SUBSUMED_CAUSE` (one for each cause of a
//! halt), `SUBSUMED_TIME` (seconds since start).
//!
//! Must never be called from a real-time thread, nor wait: a journal that does not listen costs the fields, not
//! the text.

use std::fmt::Write;
use std::os::unix::net::UnixDatagram;

use ipc::control::Event;
use rustix::fs::fstat;

/// Where journald takes entries.
const SOCKET: &str = "/run/systemd/journal/socket";

/// What else an event is about than a layer, for fields of its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct About<'a> {
    /// Wires, or ports that are tapped, by name.
    pub(crate) wires: &'a [String],
    /// Causes of a halt, by name.
    pub(crate) causes: &'a [&'a str],
}

/// The journal, if this process's words go there.
#[derive(Debug)]
pub(crate) struct Journal(UnixDatagram);

impl Journal {
    /// None when stderr is something else, or journald does not take entries.
    pub(crate) fn ours() -> Option<Journal> {
        let stream = std::env::var("JOURNAL_STREAM").ok()?;
        let stderr = fstat(std::io::stderr()).ok()?;
        if stream != format!("{}:{}", stderr.st_dev, stderr.st_ino) {
            return None;
        }
        let socket = UnixDatagram::unbound().ok()?;
        socket.connect(SOCKET).ok()?;
        socket.set_nonblocking(true).ok()?;
        Some(Journal(socket))
    }

    /// Whether the journal took the event.
    pub(crate) fn takes(&self, event: &Event, about: &About<'_>) -> bool {
        self.0.send(entry(event, about).as_bytes()).is_ok()
    }
}

/// An event as journald reads it: `FIELD=value` a line. Control characters were taken out of its text.
fn entry(event: &Event, about: &About<'_>) -> String {
    // Warning, notice, information, by syslog's numbers.
    let priority = match event.kind.as_str() {
        "halt" | "watchdog" | "policy" => 4,
        "overrun" => 5,
        _ => 6,
    };
    let mut entry = format!(
        "MESSAGE={}\nPRIORITY={priority}\nSYSLOG_IDENTIFIER=subsumed\nSUBSUMED_KIND={}\nSUBSUMED_TIME={:.3}\n",
        event.text, event.kind, event.time_s
    );
    if let Some(layer) = &event.layer {
        let _ = writeln!(entry, "SUBSUMED_LAYER={layer}");
    }
    for wire in about.wires {
        let _ = writeln!(entry, "SUBSUMED_WIRE={wire}");
    }
    for cause in about.causes {
        let _ = writeln!(entry, "SUBSUMED_CAUSE={cause}");
    }
    entry
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_has_a_line_for_each_field() {
        let event = Event {
            number: 1,
            time_s: 1.5,
            kind: "halt".into(),
            layer: Some("avoid".into()),
            text: "the body is halted".into(),
        };
        let expected = "MESSAGE=the body is halted\nPRIORITY=4\nSYSLOG_IDENTIFIER=subsumed\nSUBSUMED_KIND=halt\n\
                        SUBSUMED_TIME=1.500\nSUBSUMED_LAYER=avoid\nSUBSUMED_WIRE=turn.heading\nSUBSUMED_WIRE=turn.rate\n\
                        SUBSUMED_CAUSE=stale command\n";
        let about = About {
            wires: &["turn.heading".into(), "turn.rate".into()],
            causes: &["stale command"],
        };
        assert_eq!(entry(&event, &about), expected);
    }
}
