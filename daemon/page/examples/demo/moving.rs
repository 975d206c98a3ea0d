//! What moves: a robot on a round through the office, people, and numbers that look like a daemon's.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use crate::floor;

/// The round, in metres.
const ROUND: [(f64, f64); 12] = [
    (1.2, 3.7),
    (5.2, 3.6),
    (6.1, 4.6),
    (6.6, 5.7),
    (7.6, 5.9),
    (6.4, 5.3),
    (6.0, 3.8),
    (8.6, 3.0),
    (10.8, 2.6),
    (8.4, 3.4),
    (5.4, 2.2),
    (4.8, 3.7),
];
const SPEED_M_S: f64 = 0.45;
const SONAR_MAX_M: f64 = 5.0;

/// The state at `time_s`, of which the robot drove `driven_s`, without the halt.
pub(crate) fn state(time_s: f64, driven_s: f64, halted: bool) -> Value {
    let (x, y, heading) = on_round(driven_s * SPEED_M_S);
    let people = people(time_s);
    let ping_s = time_s.floor();
    let places: Vec<(f64, f64)> = self::people(ping_s)
        .iter()
        .map(|person| (person.0, person.1))
        .collect();
    let ping_driven_s = if halted {
        driven_s
    } else {
        driven_s - (time_s - ping_s)
    };
    let (px, py, ph) = on_round(ping_driven_s.max(0.0) * SPEED_M_S);
    let ranges: Vec<f64> = (0..12)
        .map(|index| {
            let angle = ph + f64::from(index) * TAU / 12.0;
            let noise = 0.02 * (ping_s * 12.9898 + f64::from(index) * 78.233).sin();
            let missed = (ping_s * 7.0 + f64::from(index) * 5.0) % 11.0 < 1.0;
            let seen = floor::range(px, py, angle, &places, SONAR_MAX_M);
            if missed {
                SONAR_MAX_M
            } else {
                (seen + noise).clamp(0.05, SONAR_MAX_M)
            }
        })
        .collect();
    let people: Vec<Value> = people
        .iter()
        .map(|(x, y, heading, kind)| json!({"x": x, "y": y, "heading": heading, "kind": kind}))
        .collect();
    json!({
        "time_s": time_s, "graph_version": 1, "mode": "best effort",
        "notes": ["no real-time kernel: deadlines are kept as well as the system allows"],
        "robot": {"x": x, "y": y, "heading": heading}, "people": people,
        "sonar": {"ranges_m": ranges.clone(), "max_m": SONAR_MAX_M},
        "wires": wires(time_s, heading, &ranges, halted), "taps": taps(time_s), "layers": layers(time_s),
        "events": events(time_s), "contacts": {"all": 2, "caused": 0},
    })
}

/// The time line: a layer that came, and a tap that held for 2 s every 10 s.
pub(crate) fn timeline(time_s: f64, after: u64) -> String {
    let turns = (time_s / 10.0) as u64;
    let held = (after..turns).map(|turn| {
        let from_s = turn as f64 * 10.0;
        json!({
            "number": turn + 1, "kind": "tap", "name": "avoid.heading>turn.heading", "text": "suppresses",
            "from_s": from_s, "to_s": from_s + 2.0,
        })
    });
    let came = json!({
        "number": 0, "kind": "layer", "name": "wander", "text": "level 1, pid 4711",
        "from_s": 0.0, "to_s": null,
    });
    let all: Vec<Value> = held.chain([came]).collect();
    json!({"changes": turns, "stretches": all}).to_string()
}

fn on_round(metres: f64) -> (f64, f64, f64) {
    let leg = |index: usize| {
        let (from, to) = (ROUND[index % ROUND.len()], ROUND[(index + 1) % ROUND.len()]);
        (from, to, (to.0 - from.0).hypot(to.1 - from.1))
    };
    let whole: f64 = (0..ROUND.len()).map(|index| leg(index).2).sum();
    let mut left = metres.rem_euclid(whole);
    for index in 0..ROUND.len() {
        let (from, to, length) = leg(index);
        if left <= length {
            let part = left / length;
            let heading = (to.1 - from.1).atan2(to.0 - from.0);
            return (
                from.0 + part * (to.0 - from.0),
                from.1 + part * (to.1 - from.1),
                heading,
            );
        }
        left -= length;
    }
    (ROUND[0].0, ROUND[0].1, 0.0)
}

fn people(time_s: f64) -> Vec<(f64, f64, f64, &'static str)> {
    let swing = (time_s * 0.25).sin();
    let away = if (time_s * 0.25).cos() > 0.0 {
        0.0
    } else {
        TAU / 2.0
    };
    vec![
        (7.5 + 3.2 * swing, 3.9, away, "walker"),
        (1.6, 5.7, -0.8, "walker"),
        (
            8.2 + 0.8 * (time_s * 0.5).cos(),
            1.2 + 0.5 * (time_s * 0.5).sin(),
            time_s * 0.5,
            "attacker",
        ),
    ]
}

fn wires(time_s: f64, heading: f64, ranges: &[f64], halted: bool) -> Vec<Value> {
    let near = ranges.iter().copied().fold(SONAR_MAX_M, f64::min);
    let moving = if halted { 0.0 } else { 0.45 };
    let every = |name: &str, kind: &str, value: Value, hz: f64| {
        let age_ms = (time_s * hz).fract() / hz * 1000.0;
        json!({"wire": name, "type": kind, "value": value, "age_ms": age_ms,
               "messages": (time_s * hz).floor(), "rate_hz": hz})
    };
    vec![
        every("body.sonar", "echoes", json!(ranges), 1.0),
        every(
            "body.odometry",
            "pose",
            json!([heading.cos(), heading.sin(), heading]),
            20.0,
        ),
        every("sonar.map", "map", json!(ranges), 1.0),
        every("collide.halt", "bit", json!(near < 0.3), 1.0),
        every(
            "feelforce.force",
            "force",
            json!([0.3 * heading.cos(), -0.2]),
            1.0,
        ),
        every(
            "runaway.heading",
            "heading",
            json!({"turn_rad": -0.4, "metres": 0.5}),
            0.4,
        ),
        every("wander.heading", "heading", json!(heading + 0.5), 0.1),
        every("avoid.heading", "heading", json!(heading), 1.0),
        every("turn.turn", "speed", json!(0.2 * time_s.sin()), 10.0),
        every("turn.heading", "heading", json!(heading), 0.5),
        every("forward.forward", "speed", json!(moving), 10.0),
        every("forward.busy", "bit", json!(!halted), 2.0),
        every("whenlook.look", "bit", json!(true), 0.05),
        every("stereo.free", "corridor", Value::Null, 0.05),
        every("integrate.moved", "path", json!([1.25, -0.5]), 5.0),
        every("pathplan.heading", "heading", json!(0.75), 0.2),
    ]
}

fn taps(time_s: f64) -> Vec<Value> {
    let tap = |from: &str, to: &str, kind: &str, every_s: f64, constant_s: f64| {
        let left_s = constant_s - time_s % every_s;
        json!({"from": from, "to": to, "kind": kind, "holds": left_s > 0.0,
               "remaining_ms": (left_s.max(0.0) * 1000.0).round(),
               "delivered": (time_s / every_s).floor(), "rejected": (time_s * 0.4).floor()})
    };
    vec![
        tap("avoid.heading", "turn.heading", "suppress", 3.0, 2.0),
        tap("pathplan.heading", "avoid.heading", "suppress", 12.0, 5.0),
        tap("whenlook.look", "wander.heading", "inhibit", 20.0, 8.0),
    ]
}

fn layers(time_s: f64) -> Vec<Value> {
    let layer = |name: &str, level: u32, period_ms: u32, attached: bool, middle_us: f64, overruns: u32| {
        let beats = (time_s * 1000.0 / f64::from(period_ms)).floor();
        let histogram: Vec<(f64, f64)> = (0..40)
            .map(|index| {
                let upper_us = 2.0 * 1.3_f64.powi(index);
                let away = (upper_us / middle_us).ln();
                let bulk = (beats * 0.35 * (-away * away * 3.0).exp()).floor();
                let tail = if away > 0.0 && away < 2.6 {
                    (beats * 0.004 / (1.0 + away * away)).floor()
                } else {
                    0.0
                };
                ((upper_us * 10.0).round() / 10.0, bulk + tail)
            })
            .collect();
        json!({"name": name, "level": level, "period_ms": period_ms, "beats": beats, "overruns": overruns,
               "attached": attached, "histogram": histogram, "latency_us": {
               "p50": middle_us, "p99": middle_us * 3.9, "p999": middle_us * 9.0, "max": middle_us * 13.1}})
    };
    vec![
        layer("avoid", 0, 10, false, 21.0, 0),
        layer("wander", 1, 50, true, 46.0, 3),
        layer("explore", 2, 100, false, 130.0, 0),
    ]
}

fn events(time_s: f64) -> Vec<Value> {
    let mut events = vec![
        json!({"time_s": 0.0, "text": "started, body halted"}),
        json!({"time_s": 1.2, "text": "reset by operator"}),
        json!({"time_s": 2.0, "text": "layer wander attached (pid 4711)"}),
    ];
    let whole = (time_s / 17.0).floor();
    for index in 1..=8 {
        let at_s = (whole - 8.0 + f64::from(index)) * 17.0;
        if at_s > 2.0 {
            events.push(json!({"time_s": at_s, "text": "layer wander: beat late by 1.9 ms"}));
        }
    }
    events
}
