//! The lab's creature, alive: the daemon's own threads, wires in shared memory and control socket, measured.
//!
//! Must never measure anything but what a daemon runs: it is started like one, under a name of its own, and
//! answers `subsumectl --creature NAME status` like one.

use std::time::{Duration, Instant};

use afsm::Kinds;
use daemon::admission::Admission;
use daemon::control::{self, Control};
use daemon::feeder::Fed;
use daemon::machine::Machine;
use daemon::recorder;
use daemon::running::{self, Running};
use ipc::clock::Span;
use ipc::wire::iceoryx::Domain;
use ipc::wiring::creature::{Creature, Wake};
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};

use crate::modules::{self, Heard};
use crate::probe::Host;
use crate::track::{Track, histogram};
use hdrhistogram::Histogram;

/// The lab's creature file.
pub const LAB: &str = include_str!("lab.toml");

/// How the creature is run.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The processor its layers are bound to.
    pub cpu: usize,
    /// Time between two beats of each layer; phases are scaled along.
    pub period: Span,
    /// How its threads wait.
    pub wake: Wake,
}

/// The lab's creature, alive.
pub struct Alive {
    /// Its name, for those who plug in.
    pub name: String,
    running: Option<Running>,
    control: Option<Control>,
    began: Instant,
    last: Duration,
    tracks: Vec<Track>,
    age: Histogram<u64>,
    tap: Histogram<u64>,
    threads: Vec<(String, i32, Host)>,
}

/// What the host counted of the creature's threads.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Kept {
    /// The layer, or `motor`.
    pub thread: String,
    /// Its kernel thread id.
    pub tid: i32,
    /// Beats.
    pub beats: u64,
    /// Deadlines missed.
    pub missed: u64,
    /// The longest row of them.
    pub missed_in_row_max: u64,
    /// Beats left out.
    pub skipped: u64,
    /// Times that elapsed / period was not beats + skipped.
    pub identity_faults: u64,
    /// Page faults while measured.
    pub faults: u64,
    /// Times it gave the processor away while measured: at most once a beat.
    pub sleeps: u64,
}

/// The creature as checked, bound and timed as asked for.
///
/// # Errors
/// When the period cannot be had.
///
/// # Panics
/// Never: the file is built in and tried by a test.
pub fn checked(setting: &Setting, name: &str) -> Creature {
    let source = Source::new("lab.toml (built in)", LAB);
    let mut creature = check::creature(&source, &modules::kinds()).expect("the built-in creature is sound");
    creature.name = name.into();
    for layer in &mut creature.layers {
        let scale =
            |span: Span| Span((span.0 as u128 * setting.period.0 as u128 / layer.period.0 as u128) as u64);
        (layer.phase, layer.period) = (scale(layer.phase), scale(layer.period));
        layer.cpu = Some(setting.cpu);
        layer.wake = setting.wake;
    }
    creature
}

/// Starts a creature's threads under its name, as a daemon does, but for the control socket.
///
/// # Errors
/// When the host refuses shared memory or a thread.
pub(crate) fn start(creature: Creature, kinds: &Kinds) -> Result<Running, String> {
    let name = creature.name.clone();
    let domain = Domain::join(&name).map_err(|e| e.to_string())?;
    let owned = domain
        .own(&name, output_ports(&creature).count())
        .map_err(|e| e.to_string())?;
    let machine = Machine::new(creature, kinds, owned.page().clone(), None);
    let settings = recorder::Settings::default();
    running::start(&name, machine, owned, domain, &settings, None, Fed::default()).map_err(|e| e.to_string())
}

impl Alive {
    /// Starts the creature.
    ///
    /// # Errors
    /// When the host refuses shared memory, the socket or a thread.
    pub fn start(setting: &Setting) -> Result<Alive, String> {
        let name = format!("lab{}", std::process::id());
        let creature = checked(setting, &name);
        let admission = Admission::of(&creature.outsiders)?;
        control::claim(&name).map_err(|e| e.to_string())?;
        let running = start(creature, &modules::kinds())?;
        let control = Control::open(&name, running.shared.clone(), admission)
            .map_err(|e| format!("the control socket: {e}"))?;
        // The beats of the first 200 ms warm the caches and are in nobody's interval.
        std::thread::sleep(Duration::from_millis(200));
        modules::heard(|_| ());
        let threads = running
            .threads()
            .into_iter()
            .map(|(n, tid)| (n, tid, Host::of(tid)));
        let mut alive = Alive {
            name,
            threads: threads.collect(),
            running: Some(running),
            control: Some(control),
            began: Instant::now(),
            last: Duration::ZERO,
            tracks: Vec::new(),
            age: histogram(),
            tap: histogram(),
        };
        alive.look(false);
        alive.forget();
        Ok(alive)
    }

    /// What was refused, in words; empty in real time.
    pub fn refusals(&self) -> Vec<String> {
        let refusals = self.running.iter().flat_map(|r| &r.refusals);
        refusals.map(ToString::to_string).collect()
    }

    /// Takes in what the actuator heard; to be called several times a second.
    pub fn drain(&mut self) {
        modules::heard(|heard| match heard {
            Heard::Sensed(ns) => self.age.saturating_record(ns.max(1)),
            Heard::Tapped(ns) => self.tap.saturating_record(ns.max(1)),
        });
    }

    /// Ends an interval; `kept` says whether it belongs to the measurement.
    pub fn look(&mut self, kept: bool) {
        self.drain();
        let (began, now) = (self.last, self.began.elapsed());
        let length = now - began;
        self.last = now;
        let records = self.running.as_ref().expect("alive").records.clone();
        for record in records
            .lock()
            .expect("nobody panics holding the records")
            .iter_mut()
        {
            let measured = record.measured();
            for (metric, h) in [
                ("wake-up", &measured.wake_up),
                ("step", &measured.step),
                ("period-error", &measured.period_error),
                ("response", &measured.response),
            ] {
                let seen = seen(&mut self.tracks, &record.name, metric);
                seen.add_up_to(began, length, h);
            }
        }
        let age = std::mem::replace(&mut self.age, histogram());
        seen(&mut self.tracks, "act", "age").add(began, length, age);
        let tap = std::mem::replace(&mut self.tap, histogram());
        if !tap.is_empty() {
            seen(&mut self.tracks, "tap", "effect").add(began, length, tap);
        }
        if !kept {
            self.tracks.iter_mut().for_each(|t| drop(t.intervals.pop()));
        }
    }

    /// Forgets the intervals so far, not what they add up to: it is what later ones are told from.
    fn forget(&mut self) {
        self.tracks.iter_mut().for_each(|t| t.intervals.clear());
    }

    /// Stops it; what was measured in the intervals kept, and what the host counted.
    pub fn finish(mut self) -> (Vec<Track>, Vec<Kept>) {
        let running = self.running.take().expect("alive");
        let kept = self.threads.iter().map(|(thread, tid, before)| {
            let now = Host::of(*tid);
            let records = running.records.lock().expect("nobody panics holding the records");
            let record = records.iter().find(|r| r.name == *thread);
            let counts = record.map(|r| r.gauge.counts()).unwrap_or_default();
            Kept {
                thread: thread.clone(),
                tid: *tid,
                beats: counts.beats,
                missed: counts.missed,
                missed_in_row_max: counts.missed_in_row_max,
                skipped: counts.skipped,
                identity_faults: counts.identity_faults,
                faults: now.faults - before.faults,
                sleeps: now.sleeps - before.sleeps,
            }
        });
        let kept = kept.collect();
        drop(self.control.take());
        running.shut_down();
        let mut tracks = std::mem::take(&mut self.tracks);
        for track in &mut tracks {
            let mut total = histogram();
            for interval in &track.intervals {
                total.add(&interval.histogram).expect("one shape");
            }
            track.total = total;
        }
        tracks.retain(|t| !t.total.is_empty());
        (tracks, kept)
    }
}

fn seen<'t>(tracks: &'t mut Vec<Track>, of: &str, metric: &'static str) -> &'t mut Track {
    let place = tracks.iter().position(|t| t.of == of && t.metric == metric);
    let place = place.unwrap_or_else(|| {
        tracks.push(Track::new(of, metric));
        tracks.len() - 1
    });
    &mut tracks[place]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_creature_and_its_tapper_are_sound() {
        let setting = Setting {
            cpu: 1,
            period: Span::micros(500),
            wake: Wake::Sleep,
        };
        let creature = checked(&setting, "lab-test");
        let timed: Vec<(Span, Span)> = creature.layers.iter().map(|l| (l.period, l.phase)).collect();
        let half = Span::micros(500);
        assert_eq!(
            timed,
            [
                (half, Span::ZERO),
                (half, Span::micros(150)),
                (half, Span::micros(300))
            ]
        );
        assert!(daemon::executor::plan::threads(&creature).is_ok());
    }
}
