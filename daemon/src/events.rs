//! Events: what happened, for the log, the page and the tools.
//!
//! Must never be written from a real-time thread.

use std::collections::VecDeque;
use std::sync::Mutex;

use ipc::clock::{self, Time};
use ipc::control::Event;

/// Events that are kept; older ones are in the log only.
pub const EVENTS_MAX: usize = 1000;

/// The newest events, numbered.
#[derive(Debug)]
pub struct Events {
    began: Time,
    kept: Mutex<(u64, VecDeque<Event>)>,
}

impl Events {
    /// No event yet; times count from `began`.
    pub fn new(began: Time) -> Events {
        Events {
            began,
            kept: Mutex::default(),
        }
    }

    /// Notes an event, and logs it.
    pub fn note(&self, kind: &str, layer: Option<&str>, text: impl Into<String>) {
        let time_s = clock::monotonic().since(self.began).seconds();
        let text = text.into();
        eprintln!("[{time_s:9.3}] {text}");
        let mut kept = self.kept.lock().expect("nobody panics holding events");
        kept.0 += 1;
        let number = kept.0;
        if kept.1.len() == EVENTS_MAX {
            kept.1.pop_front();
        }
        kept.1.push_back(Event {
            number,
            time_s,
            kind: kind.into(),
            layer: layer.map(Into::into),
            text,
        });
    }

    /// Events after the `after`-th, oldest first.
    pub fn after(&self, after: u64) -> Vec<Event> {
        let kept = self.kept.lock().expect("nobody panics holding events");
        kept.1.iter().filter(|e| e.number > after).cloned().collect()
    }
}
