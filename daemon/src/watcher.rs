//! The watcher: an ordinary thread that looks at everything ten times a second, and tells it as the status.
//!
//! Must never touch a real-time thread, nor decide anything but who broke the policy.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::clock::{self, Time};
use ipc::tap::Window;
use ipc::wiring::creature::How;
use serde_json::{Value, json};

use crate::alloc;
use crate::gate::Causes;
use crate::halt::CauseCount;
use crate::running::Shared;
use crate::status::{self, Rates, Record, Watched, WatchedTap};
use crate::timeline::{TimeLine, What};

/// Looks at everything ten times a second.
pub(crate) struct Watcher {
    /// What the daemon's threads share.
    pub(crate) shared: Arc<Shared>,
    /// When the daemon began.
    pub(crate) began: Time,
    /// Real time, or best effort.
    pub(crate) mode: &'static str,
    /// What the host refused.
    pub(crate) notes: Vec<String>,
    /// The creature's wires.
    pub(crate) wires: Vec<Watched>,
    /// The creature's taps.
    pub(crate) taps: Vec<WatchedTap>,
    /// What the threads measured.
    pub(crate) records: Arc<Mutex<Vec<Record>>>,
    /// What the world shows.
    pub(crate) view: Arc<Mutex<Value>>,
    /// How often each wire is written.
    pub(crate) rates: Rates,
    /// The causes at the last look.
    pub(crate) causes: Causes,
    /// What was counted of them then.
    pub(crate) counts: Vec<CauseCount>,
}

impl Watcher {
    /// Looks until told to `leave`.
    ///
    /// # Errors
    /// When the host refuses the thread.
    pub(crate) fn watch(mut self, leave: Arc<AtomicBool>) -> std::io::Result<JoinHandle<()>> {
        std::thread::Builder::new().name("watcher".into()).spawn(move || {
            while !leave.load(Ordering::Relaxed) {
                self.look();
                std::thread::sleep(Duration::from_millis(100));
            }
        })
    }

    fn look(&mut self) {
        let now = clock::monotonic();
        for record in self
            .records
            .lock()
            .expect("nobody panics holding the records")
            .iter_mut()
        {
            if let Some(text) = record.drain() {
                let at = now.since(self.began).seconds();
                self.timeline().moment(What::Overrun, &record.name, &text, at);
                self.shared.events.note("overrun", Some(&record.name), text);
            }
        }
        self.note_halts();
        self.shared.plugs.police(now);
        let (status, taps) = self.status(now);
        self.keep_timeline(now, &taps);
        self.shared.set_status(status);
    }

    /// Notes when the body halts and goes on; a reflex is everyday life and not noted.
    fn note_halts(&mut self) {
        let counts = self.shared.halt.counts();
        let causes = self.shared.halt.decided().0.without(Causes::REFLEX);
        // Causes that began since the last look, some of them perhaps over again.
        for CauseCount { cause, count, began } in &counts {
            let before = self
                .counts
                .iter()
                .find(|c| c.cause == *cause)
                .map_or(0, |c| c.count);
            if *count > before && !self.shared.halt.decided().0.has(*cause) {
                let at = began.since(self.began).seconds();
                let (name, text) = (cause.names().join(""), "the body was halted for a moment");
                self.timeline().moment(halted_by(*cause), &name, text, at);
            }
            let unseen = count - before - u64::from(causes.has(*cause) && !self.causes.has(*cause));
            if *cause == Causes::REFLEX || before == *count || before == 0 || unseen == 0 {
                continue;
            }
            let at = began.since(self.began).seconds();
            let name = cause.names().join("");
            let text =
                format!("the body was halted for a moment: {name} ({unseen} times, last at {at:.3} s)");
            self.shared.events.note_causes("halt", None, &cause.names(), text);
        }
        self.counts = counts;
        if causes == self.causes {
            return;
        }
        let text = match causes {
            Causes::NONE => "the body may move".to_string(),
            some => format!("the body is halted: {}", some.names().join(", ")),
        };
        self.causes = causes;
        self.shared
            .events
            .note_causes("halt", None, &causes.names(), text);
    }

    fn timeline(&self) -> MutexGuard<'_, TimeLine> {
        let line = &self.shared.timeline;
        line.lock().expect("nobody panics holding the time line")
    }

    /// Keeps what stands now, to a tenth of a second: causes of a halt, attached layers, taps that hold.
    fn keep_timeline(&self, now: Time, taps: &[(String, &'static str, Window)]) {
        let seconds = |at: Time| at.since(self.began).seconds();
        let (attached, now_s) = (self.shared.plugs.attached(), seconds(now));
        let mut line = self.timeline();
        let causes = self.shared.halt.decided().0;
        for CauseCount { cause, began, .. } in &self.counts {
            if causes.has(*cause) {
                let (name, text) = (cause.names().join(""), "the body was halted");
                line.stands(halted_by(*cause), &name, text, seconds(*began));
            }
        }
        for what in [What::Halt, What::Reflex] {
            line.only(what, &causes.names(), now_s, |_| None);
        }
        let names: Vec<&str> = attached.iter().map(|a| a.plug.layer.as_str()).collect();
        for a in &attached {
            let text = format!("level {}, pid {}", a.plug.level, a.plug.pid);
            line.stands(What::Layer, &a.plug.layer, &text, now_s);
        }
        line.only(What::Layer, &names, now_s, |name| {
            let events = self.shared.events.after(0);
            let last = events.iter().rev().find(|e| e.layer.as_deref() == Some(name));
            last.map(|e| e.text.clone())
        });
        for (name, how, window) in taps {
            let from = seconds(window.stamp);
            line.holds(What::Tap, name, how, from, from + window.time_constant.seconds());
        }
    }

    fn count(&self, counted: &CauseCount, causes: Causes) -> Value {
        json!({
            "cause": counted.cause.names().join(""), "count": counted.count,
            "last_s": counted.began.since(self.began).seconds(), "stands": causes.has(counted.cause),
            "latches": Causes::LATCHED.has(counted.cause),
        })
    }

    /// The status, and the windows of the taps in it.
    fn status(&mut self, now: Time) -> (Value, Vec<(String, &'static str, Window)>) {
        let attached = self.shared.plugs.attached();
        let mut wires: Vec<Value> = self
            .wires
            .iter()
            .map(|w| status::wire(w, &mut self.rates, now))
            .collect();
        let mut taps: Vec<Value> = self.taps.iter().map(|t| status::tap(t, now)).collect();
        let mut windows: Vec<_> = self.taps.iter().filter_map(|t| windowed(t, now)).collect();
        let mut layers = status::layers(&self.records.lock().expect("nobody panics holding the records"));
        for a in &attached {
            layers.push(status::attached(a));
            for (index, output) in a.plug.outputs.iter().enumerate() {
                let Some(reader) = a.page.reader(index, output.kind) else {
                    continue;
                };
                let watched = Watched {
                    name: output.name.clone(),
                    unit: output.unit.clone(),
                    reader,
                };
                wires.push(status::wire(&watched, &mut self.rates, now));
            }
            for t in &a.taps {
                let watched = WatchedTap {
                    how: t.tap.how,
                    from: t.tap.from.clone(),
                    to: t.tap.to.clone(),
                    time_constant: t.tap.time_constant,
                    layer: (a.plug.layer.clone(), a.plug.level),
                    reader: t.reader.clone(),
                    gauge: t.gauge.clone(),
                    at: t.at.clone(),
                    joined: t.joined,
                };
                taps.push(status::tap(&watched, now));
                windows.extend(windowed(&watched, now));
            }
        }
        self.rates.keep_only(&wires);
        let (causes, since) = self.shared.halt.decided();
        let events = self.shared.events.after(0);
        let newest: Vec<_> = events.iter().rev().take(50).rev().collect();
        let mut status = json!({
            "creature": self.shared.name, "pid": std::process::id(),
            "time_s": now.since(self.began).seconds(), "graph_version": self.shared.plugs.version() + mechanisms::desk::revision(),
            "mode": self.mode, "notes": self.notes,
            "halt": {
                "halted": causes != Causes::NONE, "causes": causes.names(),
                "since_s": since.since(self.began).seconds(), "latched": causes.has(Causes::LATCHED),
                "counts": self.shared.halt.counts().iter().map(|c| self.count(c, causes)).collect::<Vec<_>>(),
            },
            "wires": wires, "taps": taps, "layers": layers, "events": newest,
            "real_time_allocations": alloc::broken(),
        });
        let view = self.view.lock().expect("nobody panics holding the view").clone();
        if let (Some(status), Value::Object(view)) = (status.as_object_mut(), view) {
            status.extend(view);
        }
        (status, windows)
    }
}

/// What a cause of a halt is on the time line.
fn halted_by(cause: Causes) -> What {
    if cause == Causes::REFLEX {
        What::Reflex
    } else {
        What::Halt
    }
}

/// A tap by name, what it does, and the window of its newest message.
fn windowed(tap: &WatchedTap, now: Time) -> Option<(String, &'static str, Window)> {
    let how = match tap.how {
        How::Suppress => "suppresses",
        How::Inhibit => "inhibits",
    };
    let window = status::window(tap, now)?;
    Some((format!("{}>{}", tap.from, tap.to), how, window))
}
