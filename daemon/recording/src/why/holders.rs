//! Holders: for every tapped port who holds it, and who gets it next.
//!
//! Must never count a tap whose layer has left and whose window has run out.

use std::collections::BTreeMap;

use ipc::clock::Time;
use ipc::wiring::creature::How;
use serde::Serialize;

use super::{TapSeen, before, tap_seen};
use crate::manifest::Tap;
use crate::reader::Recording;

/// Who holds a tapped port.
#[derive(Clone, Debug, Serialize)]
pub struct Holder {
    /// The port.
    pub port: String,
    /// Which way it is tapped.
    pub kind: How,
    /// Who holds it: the wire of a tap, or the port's own wire; none if it has none.
    pub holder: Option<String>,
    /// The layer of the tap that holds it.
    pub layer: Option<String>,
    /// How long the tap holds it still, in milliseconds.
    pub left_ms: f64,
    /// Who gets it next if nothing more is said; none if the tap does not hold.
    pub next: Option<String>,
    /// Every tap on it, in series.
    pub taps: Vec<TapSeen>,
}

/// For every tapped port who holds it at the moment `at`, and who gets it next.
pub fn holders(recording: &Recording, at: Time) -> Vec<Holder> {
    let gone = |plug: u32| {
        recording
            .unplugs
            .iter()
            .any(|(time, p)| *p == plug && *time <= at)
    };
    let came = |plug: u32| {
        recording
            .plugs
            .iter()
            .any(|(time, p)| p.number == plug && *time <= at)
    };
    let mut ports: BTreeMap<(String, bool), Vec<(u32, Tap)>> = BTreeMap::new();
    for (plug, tap) in recording.taps() {
        let newest = tap_newest(recording, plug, &tap, at);
        let running = newest.is_some_and(|stamp| stamp + tap.time_constant > at);
        let manifest = &recording.manifest;
        let filed = manifest.register_of(&tap.to).is_some() || manifest.writer_of(&tap.to).is_some();
        // A port of a layer that has gone is nobody's.
        if !filed && recording.owner_of(&tap.to, at).is_none_or(|(_, gone)| gone) {
            continue;
        }
        if plug == 0 || running || came(plug) && !gone(plug) {
            let key = (tap.to.clone(), tap.how == How::Inhibit);
            ports.entry(key).or_default().push((plug, tap));
        }
    }
    let holder = |((port, _), mut taps): ((String, bool), Vec<(u32, Tap)>)| {
        // In series: by level, and within one by the order in which they were declared.
        taps.sort_by_key(|(_, t)| t.level);
        let seen = |(plug, tap): &(u32, Tap)| tap_seen(tap, tap_newest(recording, *plug, tap, at), at);
        hold(
            recording,
            (port, taps[0].1.how),
            taps.iter().map(seen).collect(),
            at,
        )
    };
    ports.into_iter().map(holder).collect()
}

fn tap_newest(recording: &Recording, plug: u32, tap: &Tap, at: Time) -> Option<Time> {
    let messages = recording.wires.get(&(plug, tap.from.clone()))?;
    before(messages, at).map(|m| m.stamp)
}

fn hold(recording: &Recording, (port, kind): (String, How), taps: Vec<TapSeen>, at: Time) -> Holder {
    let attached = || {
        let (owner, _) = recording.owner_of(&port, at)?;
        let (from, _) = owner.plug.wires.iter().find(|(_, to)| *to == port)?;
        Some(from.clone())
    };
    let own = match kind {
        How::Suppress => recording
            .manifest
            .wire_into(&port)
            .map(str::to_string)
            .or_else(attached),
        How::Inhibit => Some(port.clone()),
    };
    // The last in the series that holds rejects what all before it bring.
    let holder = taps.iter().rev().find(|t| t.holds);
    let next = holder.map(|h| {
        let later = taps.iter().rev().find(|t| t.left_ms > h.left_ms);
        later
            .map(|t| t.from.clone())
            .or(own.clone())
            .unwrap_or_else(|| "nobody".into())
    });
    Holder {
        kind,
        holder: holder.map(|h| h.from.clone()).or(own),
        layer: holder.map(|h| h.layer.clone()),
        left_ms: holder.map_or(0.0, |h| h.left_ms),
        next,
        port,
        taps,
    }
}
