//! What a scenario file says happens from outside: messages put, layers that come and go, halts.
//!
//! Must never put a message that is none, or on a wire that is not there.

use std::ops::Range;
use std::sync::Arc;

use daemon::virtual_run::Stimulus;
use ipc::clock::Span;
use ipc::message::{Kind, WORDS_MAX};
use ipc::wiring::diagnostic::Findings;
use ipc::wiring::document::{self as doc, Keys};

use crate::names::Names;
use crate::values;

/// Most messages that one scenario puts: a kilohertz for a quarter of an hour.
const PUTS_MAX: u64 = 1_000_000;

/// Something that happens, before repetitions are spread out.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// A stimulus of the run.
    Plain(Stimulus),
    /// A layer joins: its name among the manifests.
    Plug(String),
}

#[derive(Clone, Debug)]
struct Repeated {
    at: Span,
    every: Option<(Span, Option<Span>)>,
    place: Range<usize>,
    event: Event,
}

/// Everything that happens from outside.
#[derive(Debug, Default)]
pub(crate) struct Stimuli {
    events: Vec<Repeated>,
    /// Every time named, with its place.
    pub(crate) times: Vec<(Span, Range<usize>)>,
    /// Highest level that is meddled with.
    pub(crate) level: u8,
    /// The layers that join: place and level.
    pub(crate) plugged: Vec<(Range<usize>, u8)>,
}

/// Reads all stimuli of the file.
pub(crate) fn read(keys: &mut Keys<'_, '_>, names: &Names, stimuli: &mut Stimuli, findings: &mut Findings) {
    if let Some(list) = keys.take("put") {
        for item in doc::array(list, "messages, each as a [[put]] table", findings) {
            if let Some(keys) = doc::table(item, "this [[put]]", findings) {
                put(keys, names, stimuli, findings);
            }
        }
    }
    for what in ["plug", "unplug", "kill", "freeze", "thaw"] {
        let Some(list) = keys.take(what) else { continue };
        for item in doc::array(list, &format!("layers, each as a [[{what}]] table"), findings) {
            if let Some(keys) = doc::table(item, format!("this [[{what}]]"), findings) {
                layer(what, keys, names, stimuli, findings);
            }
        }
    }
    for (what, stimulus) in [("halt", Stimulus::Halt), ("reset", Stimulus::Reset)] {
        let Some(list) = keys.take(what) else { continue };
        for item in doc::array(list, &format!("moments, each as a [[{what}]] table"), findings) {
            if let Some(mut keys) = doc::table(item, format!("this [[{what}]]"), findings) {
                for (at, place) in moments(&mut keys, findings) {
                    stimuli.add(at, place, Event::Plain(stimulus.clone()));
                }
                keys.finish(findings);
            }
        }
    }
}

fn moments(keys: &mut Keys<'_, '_>, findings: &mut Findings) -> Vec<(Span, Range<usize>)> {
    let given = keys.need("at", findings);
    given.map(|v| values::times(v, findings)).unwrap_or_default()
}

fn put(mut keys: Keys<'_, '_>, names: &Names, stimuli: &mut Stimuli, findings: &mut Findings) {
    let times = moments(&mut keys, findings);
    let every = keys.take("every").and_then(|v| doc::span(v, true, findings));
    let until = keys.take("until").map(|v| (v, doc::span(v, true, findings)));
    if let (None, Some((given, _))) = (every, &until) {
        findings.error(
            given.span(),
            "an end of no repetition",
            "add every = \"...\", or remove until",
        );
    }
    let wire = keys
        .need("wire", findings)
        .and_then(|v| doc::text(v, "a wire such as \"sonar.map\"", findings));
    let given = keys.take("value");
    let place = keys.at();
    keys.finish(findings);
    let Some(wire) = wire else { return };
    let Some((kind, level)) = names.find(&names.outputs, "wire", &wire.value, wire.at.clone(), findings)
    else {
        return;
    };
    let words = match given {
        Some(given) => values::value(given, kind, findings).map(|(words, _)| words),
        None if kind == Kind::Pulse => Some([0.0; WORDS_MAX]),
        None => {
            let message = format!("a message without a value on a wire that carries {kind}");
            findings.error(place, message, "add value = ...");
            None
        }
    };
    let Some(words) = words else { return };
    stimuli.level = stimuli.level.max(level);
    let until = until.and_then(|(_, span)| span);
    for (at, place) in times {
        stimuli.times.push((at, place.clone()));
        stimuli.events.push(Repeated {
            at,
            every: every.map(|every| (every, until)),
            place,
            event: Event::Plain(Stimulus::Put(wire.value.clone(), words)),
        });
    }
}

fn layer(what: &str, mut keys: Keys<'_, '_>, names: &Names, stimuli: &mut Stimuli, findings: &mut Findings) {
    let times = moments(&mut keys, findings);
    let given = keys
        .need("layer", findings)
        .and_then(|v| doc::text(v, "the name of a layer", findings));
    keys.finish(findings);
    let Some(given) = given else { return };
    let own = names.layers.get(&given.value).copied();
    let manifest = names.manifests.get(&given.value).cloned();
    let (level, name) = match (what, manifest, own) {
        (_, Some((level, name)), _) => (level, name),
        // Any layer may stand still, the creature's own too.
        ("freeze" | "thaw", None, Some(level)) => (level, given.value.clone()),
        _ => {
            names.find(&names.manifests, "manifest", &given.value, given.at, findings);
            return;
        }
    };
    if what == "plug" {
        stimuli.plugged.push((given.at, level));
    }
    stimuli.level = stimuli.level.max(level);
    for (at, place) in times {
        let event = match what {
            "plug" => Event::Plug(given.value.clone()),
            "unplug" | "kill" => Event::Plain(Stimulus::Leave(name.clone())),
            "freeze" => Event::Plain(Stimulus::Freeze(name.clone())),
            _ => Event::Plain(Stimulus::Thaw(name.clone())),
        };
        stimuli.add(at, place, event);
    }
}

impl Stimuli {
    fn add(&mut self, at: Span, place: Range<usize>, event: Event) {
        self.times.push((at, place.clone()));
        self.events.push(Repeated {
            at,
            every: None,
            place,
            event,
        });
    }

    /// The last time named.
    pub(crate) fn latest(&self) -> Span {
        let ends = self.events.iter().filter_map(|e| e.every?.1);
        let times = self.times.iter().map(|(time, _)| *time);
        ends.chain(times).max().unwrap_or_default()
    }

    /// Every event at its time, repetitions spread out up to `end`.
    pub(crate) fn spread(&self, end: Span, findings: &mut Findings) -> Vec<(Span, Event)> {
        let mut spread = Vec::new();
        for repeated in &self.events {
            let Some((every, until)) = repeated.every else {
                spread.push((repeated.at, repeated.event.clone()));
                continue;
            };
            let until = until.unwrap_or(end).min(end);
            let times = until.0.saturating_sub(repeated.at.0).div_ceil(every.0);
            if times > PUTS_MAX {
                let help = format!("expected at most {PUTS_MAX} messages");
                findings.error(repeated.place.clone(), format!("repeated {times} times"), help);
                continue;
            }
            let each = |n| (Span(repeated.at.0 + n * every.0), repeated.event.clone());
            spread.extend((0..times).map(each));
        }
        spread.sort_by_key(|(at, _)| *at);
        spread
    }
}

impl Event {
    /// The stimulus, its manifest looked up.
    pub(crate) fn stimulus(
        self,
        manifest: impl Fn(&str) -> Option<Arc<daemon::virtual_run::Manifest>>,
    ) -> Option<Stimulus> {
        match self {
            Event::Plain(stimulus) => Some(stimulus),
            Event::Plug(name) => manifest(&name).map(Stimulus::Plug),
        }
    }
}
