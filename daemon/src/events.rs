//! Events: what happened, for the log, the page and the tools.
//!
//! Must never be written from a real-time thread.

use std::collections::VecDeque;
use std::sync::Mutex;

use ipc::clock::{self, Time};
use ipc::control::Event;

use crate::journal::{About, Journal};

/// Events that are kept; older ones are in the log only.
pub const EVENTS_MAX: usize = 1000;

/// Longest text of an event: reasons may repeat what a caller sent.
pub const TEXT_MAX: usize = 600;

/// Most events a second about callers and layers, who could otherwise push everything else out by coming and
/// going. What is more is counted.
const CALLERS_EVENTS_MAX: u32 = 50;

/// The newest events, numbered.
#[derive(Debug)]
pub struct Events {
    began: Time,
    journal: Option<Journal>,
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    last: u64,
    events: VecDeque<Event>,
    /// The second that is being counted, events of callers in it, and how many of them were left out.
    second: u64,
    count: u32,
    left_out: u64,
}

impl Events {
    /// No event yet; times count from `began`.
    pub fn new(began: Time) -> Events {
        Events {
            began,
            journal: Journal::ours(),
            kept: Mutex::default(),
        }
    }

    /// Notes an event, and logs it. The text may hold what a stranger sent: it is cut to [`TEXT_MAX`] and its
    /// control characters are replaced.
    pub fn note(&self, kind: &str, layer: Option<&str>, text: impl Into<String>) {
        self.note_about(kind, layer, About::default(), text);
    }

    /// The same about wires, or ports that are tapped, by name.
    pub fn note_wires(&self, kind: &str, layer: Option<&str>, wires: &[String], text: impl Into<String>) {
        let causes = &[];
        self.note_about(kind, layer, About { wires, causes }, text);
    }

    /// The same about a halt, with its causes by name.
    pub fn note_causes(&self, kind: &str, layer: Option<&str>, causes: &[&str], text: impl Into<String>) {
        let wires = &[];
        self.note_about(kind, layer, About { wires, causes }, text);
    }

    fn note_about(&self, kind: &str, layer: Option<&str>, about: About<'_>, text: impl Into<String>) {
        let time_s = clock::monotonic().since(self.began).seconds();
        let mut kept = self.kept.lock().expect("nobody panics holding events");
        let second = time_s as u64;
        if kept.second != second {
            (kept.second, kept.count) = (second, 0);
            let left_out = std::mem::take(&mut kept.left_out);
            if left_out > 0 {
                let text = format!("{left_out} more events of layers and callers were left out");
                self.log(kept.keep(time_s, kind, None, text), &About::default());
            }
        }
        if matches!(kind, "layer" | "caller") {
            kept.count += 1;
            if kept.count > CALLERS_EVENTS_MAX {
                kept.left_out += 1;
                return;
            }
        }
        self.log(
            kept.keep(time_s, kind, layer.map(plain), plain(&text.into())),
            &about,
        );
    }

    /// To the journal with fields, if it is ours; as readable text otherwise.
    fn log(&self, event: &Event, about: &About<'_>) {
        if !self.journal.as_ref().is_some_and(|j| j.takes(event, about)) {
            eprintln!("[{:9.3}] {}", event.time_s, event.text);
        }
    }

    /// Events after the `after`-th, oldest first.
    pub fn after(&self, after: u64) -> Vec<Event> {
        let kept = self.kept.lock().expect("nobody panics holding events");
        kept.events.iter().filter(|e| e.number > after).cloned().collect()
    }
}

impl Kept {
    fn keep(&mut self, time_s: f64, kind: &str, layer: Option<String>, text: String) -> &Event {
        self.last += 1;
        if self.events.len() == EVENTS_MAX {
            self.events.pop_front();
        }
        self.events.push_back(Event {
            number: self.last,
            time_s,
            kind: kind.into(),
            layer,
            text,
        });
        self.events.back().expect("one was just put in")
    }
}

/// `text` without what a terminal or a log would obey, and not too long.
fn plain(text: &str) -> String {
    let shown = text.chars().map(|c| if c.is_control() { '?' } else { c });
    let mut plain: String = shown.take(TEXT_MAX).collect();
    if plain.len() < text.len() && plain.chars().count() == TEXT_MAX {
        plain.push('…');
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn callers_cannot_flood_the_events_nor_write_to_the_terminal() {
        let events = Events::new(clock::monotonic());
        events.note("layer", None, format!("\x1b[2J{}\n", "x".repeat(10_000)));
        let first = &events.after(0)[0];
        assert!(!first.text.contains(char::is_control) && first.text.chars().count() <= TEXT_MAX + 1);
        for _ in 0..10_000 {
            events.note("layer", None, "refused");
        }
        events.note("halt", None, "the body is halted");
        let kept = events.after(0);
        assert!(kept.len() < 200, "{}", kept.len());
        assert_eq!(kept.last().map(|e| e.kind.as_str()), Some("halt"));
    }
}
