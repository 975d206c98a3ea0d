//! Recordings of creatures that race: written, read, replayed to the bit, asked why, and kept in a ring.

use std::sync::Arc;

use afsm::trace::{Trace, trace};
use daemon::body;
use daemon::gate::Causes;
use daemon::machine::{Machine, kinds};
use daemon::replay::replay;
use daemon::virtual_run::BEGIN;
use ipc::clock::{Span, Time};
use ipc::wire::Page;
use ipc::wiring::creature::Creature;
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};
use recording::{Item, Manifest, Recording, Ring, Writer, reader, why};

/// Allen with level 1 linked in: a tap of the file itself.
fn text() -> String {
    let layer = allen::WANDER.find("[[layer]]").expect("the manifest has a layer");
    format!("{}\n{}", allen::CREATURE, &allen::WANDER[layer..])
}

fn creature(text: &str) -> Creature {
    let checked = check::creature(&Source::new("allen.toml", text), &kinds());
    checked.unwrap_or_else(|rejected| panic!("{rejected}"))
}

/// Lives for `seconds` on threads that exist only in name: beats begin late and end late, by chance, so that
/// layers find what others wrote a moment ago, or just don't.
fn live(text: &str, seconds: u64) -> (Arc<Manifest>, Vec<Item>) {
    let creature = creature(text);
    let causes = Causes::named().map(|(_, name)| name.to_string()).collect();
    let manifest = Arc::new(Manifest::of(&creature, "allen", text, BEGIN, causes));
    let page = Page::in_memory(output_ports(&creature).count());
    let mut machine = Machine::new(creature, &kinds(), page, None);
    let mut traces: Vec<Trace> = Vec::new();
    for station in &mut machine.stations {
        let (registers, outlets) = station.running.ports();
        let (tracer, out) = trace(station.spec.period, registers, outlets);
        station.running.trace(tracer);
        traces.push(out);
    }
    let mut body = machine.body.take().expect("Allen has a body");
    let (registers, outlets) = body.motor.ports();
    let (tracer, out) = trace(body.motor.period(), registers, outlets);
    body.motor.trace(tracer);
    traces.push(out);
    let mut dice = 0x9e37_79b9_7f4a_7c15_u64;
    let mut throw = move |below: u64| {
        dice ^= dice << 13;
        dice ^= dice >> 7;
        dice ^= dice << 17;
        dice % below
    };
    // Moments at which somebody steps (looks) or commits (writes), in time order.
    let motor = machine.stations.len();
    let mut due: Vec<(Time, bool)> = vec![(BEGIN, true); motor + 1];
    let mut items = Vec::new();
    let mut next_due: Vec<Time> = vec![BEGIN; motor + 1];
    loop {
        let (who, &(now, steps)) = due
            .iter()
            .enumerate()
            .min_by_key(|(_, (t, _))| *t)
            .expect("somebody is due");
        if now.since(BEGIN) >= Span::secs(seconds) {
            return (manifest, items);
        }
        let period = machine
            .stations
            .get(who)
            .map_or(body.motor.period(), |s| s.spec.period);
        match (who == motor, steps) {
            (true, true) => body.motor.gather(now),
            (true, false) => {
                machine.watchdog.look(now);
                machine.halt.watchdog.beat(now);
                body.motor.act(now);
                body.gauge.beat(now);
                body::turn(body.world.as_mut(), &mut body.link, || now);
            }
            (false, true) => machine.stations[who].running.step(now),
            (false, false) => {
                machine.stations[who].running.commit(now);
                machine.stations[who].gauge.beat(now);
            }
        }
        if !steps {
            next_due[who] = next_due[who] + period;
            let source = who as u16;
            let words = traces[who].next_beat().expect("a beat was traced");
            items.push(Item::Beat { source, words });
        }
        // A beat takes up to 2 ms and begins up to 3 ms late.
        let then = if steps {
            now + Span::micros(1 + throw(2000))
        } else {
            next_due[who] + Span::micros(throw(3000))
        };
        due[who] = (then, !steps);
    }
}

fn written(manifest: &Arc<Manifest>, items: &[Item]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes, manifest).expect("memory takes it");
    items
        .iter()
        .for_each(|item| writer.write(item).expect("memory takes it"));
    assert_eq!(writer.finish().expect("memory takes it"), 0, "nothing is lost");
    bytes
}

fn recorded(manifest: &Arc<Manifest>, items: &[Item]) -> Recording {
    reader::parse(&written(manifest, items)).unwrap_or_else(|e| panic!("the recording {e}"))
}

#[test]
fn the_same_build_gives_the_same_outputs_however_the_threads_raced() {
    let text = text();
    let (manifest, items) = live(&text, 60);
    let recording = recorded(&manifest, &items);
    assert_eq!(recording.manifest, *manifest);
    let outcome = replay(&recording, &creature(&text), &kinds());
    assert_eq!(outcome.differing(), 0, "{outcome:?}");
    assert!(outcome.doubts.is_empty(), "{:?}", outcome.doubts);
    assert!(outcome.outputs["turn.rate"].replayed > 5000 && outcome.outputs["body.turn"].replayed > 2500);
    assert!(
        outcome.outputs["avoid.heading"].replayed > 30,
        "level 1 was replayed too"
    );
}

#[test]
fn another_creature_gives_other_outputs_and_they_are_placed() {
    let text = text();
    let (manifest, items) = live(&text, 30);
    let recording = recorded(&manifest, &items);
    let changed = text.replace("every = \"1s\"", "every = \"1500ms\"");
    assert_ne!(changed, text);
    let outcome = replay(&recording, &creature(&changed), &kinds());
    let first = outcome.outputs["sonar.ping"]
        .first
        .clone()
        .expect("the sonar pings at other times");
    assert!(first.time_s > 0.5 && first.time_s < 2.0, "{first:?}");
    // Without level 1 the rest is still compared, and what is missing is said.
    let outcome = replay(&recording, &creature(allen::CREATURE), &kinds());
    assert!(
        outcome.doubts.iter().any(|d| d.contains("wander")),
        "{:?}",
        outcome.doubts
    );
    assert!(
        outcome.outputs["turn.rate"].differing > 0,
        "nobody wanders: {outcome:?}"
    );
    assert_eq!(outcome.outputs["sonar.ping"].differing, 0);
}

#[test]
fn a_beat_that_is_missing_is_told() {
    let (manifest, mut items) = live(&text(), 5);
    items.remove(items.len() / 2);
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes, &manifest).expect("memory takes it");
    items
        .iter()
        .for_each(|item| writer.write(item).expect("memory takes it"));
    let lost = writer.finish().expect("memory takes it");
    let recording = reader::parse(&bytes).expect("it reads");
    assert_eq!(recording.beats_missing(), 1);
    assert_eq!(recording.losses.values().sum::<u64>(), lost);
    let outcome = replay(&recording, &creature(&text()), &kinds());
    assert!(
        outcome.doubts.iter().any(|d| d.contains("1 beats are missing")),
        "{:?}",
        outcome.doubts
    );
}

#[test]
fn a_recording_that_was_cut_off_reads_as_far_as_it_goes() {
    let (manifest, items) = live(&text(), 20);
    let bytes = written(&manifest, &items);
    let whole = reader::parse(&bytes).expect("it reads");
    for part in [3, 2] {
        let cut = reader::parse(&bytes[..bytes.len() * (part - 1) / part]).expect("it reads");
        assert!(
            !cut.whole && cut.span() < whole.span() && cut.span() > Span::secs(5),
            "{:?}",
            cut.span()
        );
    }
    assert!(reader::parse(b"no MCAP at all").is_err());
    assert!(reader::parse(&[]).is_err());
}

#[test]
fn a_ring_forgets_the_past_but_not_what_is_held() {
    let (manifest, items) = live(&text(), 60);
    let end = items.last().expect("items").time();
    let mut ring = Ring::new(&manifest, Span::secs(5), usize::MAX);
    items.iter().for_each(|item| ring.push(item.clone()));
    assert!(
        ring.covers() <= Span::secs(5) && ring.covers() > Span::millis(4900),
        "{:?}",
        ring.covers()
    );
    let (all, part) = (recorded(&manifest, &items), recorded(&manifest, &ring.snapshot()));
    assert!(!part.from_the_beginning());
    // The chain behind a message is the same, though most of it happened before the ring begins.
    for wire in ["body.turn", "body.forward", "turn.rate"] {
        let (long, short) = (
            why::why(&all, wire, end).expect("a chain"),
            why::why(&part, wire, end).expect("a chain"),
        );
        assert_eq!((long.number, &long.value), (short.number, &short.value), "{wire}");
        let held = |link: &why::Link| {
            link.inputs
                .iter()
                .map(|i| i.held.as_ref().map(|h| (h.wire.clone(), h.number)))
                .collect::<Vec<_>>()
        };
        assert_eq!(held(&long), held(&short), "{wire}");
        let (a, b) = (&long.inputs[0].held, &short.inputs[0].held);
        if let (Some(a), Some(b)) = (a, b) {
            assert_eq!(held(a), held(b), "{wire}, one further back");
        }
    }
    // Bounded in bytes as well.
    let mut small = Ring::new(&manifest, Span::secs(60), 100_000);
    items.iter().for_each(|item| small.push(item.clone()));
    let bytes: usize = small
        .snapshot()
        .iter()
        .filter(|i| matches!(i, Item::Beat { .. }))
        .map(Item::bytes)
        .sum();
    assert!(bytes <= 100_000 && bytes > 90_000, "{bytes}");
}

#[test]
fn why_leads_from_the_body_to_the_sensors_and_ends() {
    let (manifest, items) = live(&text(), 30);
    let end = items.last().expect("items").time();
    let recording = recorded(&manifest, &items);
    let chain = why::why(&recording, "body.turn", end).expect("a chain");
    let (mut wires, mut taps) = (Vec::new(), Vec::new());
    collect(&chain, &mut wires, &mut taps);
    for wire in ["turn.rate", "avoid.heading", "body.compass", "body.sonar"] {
        assert!(
            wires.iter().any(|w| w == wire),
            "{wire} is not behind body.turn: {wires:?}"
        );
    }
    assert!(
        taps.contains(&"wander".to_string()),
        "level 1 brought the heading"
    );
    for wire in why::names(&recording) {
        let _ = why::why(&recording, &wire, end);
    }
    let heading = why::why(&recording, "turn.heading", end).expect("an input port");
    assert_eq!(heading.inputs[0].tap.as_deref(), Some("wander"));
    assert!(
        why::why(&recording, "turn.rat", end)
            .unwrap_err()
            .contains("turn.rate")
    );
}

fn collect(link: &why::Link, wires: &mut Vec<String>, taps: &mut Vec<String>) {
    wires.push(link.wire.clone());
    for input in &link.inputs {
        taps.extend(input.tap.clone());
        if let Some(held) = &input.held {
            collect(held, wires, taps);
        }
    }
}

#[test]
fn holders_fall_back_to_the_wire_when_the_window_runs_out() {
    let (manifest, items) = live(&text(), 30);
    let recording = recorded(&manifest, &items);
    let spoke = recording.wires[&(0, "avoid.heading".to_string())]
        .last()
        .expect("level 1 spoke")
        .stamp;
    let at = |t: Time| {
        why::holders(&recording, t)
            .into_iter()
            .find(|h| h.port == "turn.heading")
            .expect("tapped")
    };
    let held = at(spoke + Span::millis(1900));
    assert_eq!(held.holder.as_deref(), Some("avoid.heading"));
    assert_eq!(held.next.as_deref(), Some("runaway.heading"));
    assert!((held.left_ms - 100.0).abs() < 1e-6, "{held:?}");
    let free = at(spoke + Span::secs(2));
    assert_eq!(
        (free.holder.as_deref(), free.next),
        (Some("runaway.heading"), None)
    );
}
