//! The status as OpenMetrics 1.0 text.
//!
//! Must never change a bucket's bounds or a family's name between two scrapes.

use std::fmt::Write as _;

use serde_json::Value;

use crate::gate::Causes;

/// Upper bounds of latency buckets: 1 µs doubling to about a second.
const BUCKETS: u32 = 21;

/// Numbers of the status, as families of metrics.
pub fn text(status: &Value) -> String {
    let mut page = Page {
        creature: status["creature"].as_str().unwrap_or_default().into(),
        text: String::new(),
    };
    let threads: Vec<&Value> = list(status, "layers").filter(|l| l["attached"] != true).collect();
    let attached: Vec<&Value> = list(status, "layers").filter(|l| l["attached"] == true).collect();
    let version = env!("CARGO_PKG_VERSION");
    page.family("subsumed", "info", "The program and how it runs.");
    page.sample(
        "subsumed_info",
        &[("version", version), ("mode", word(&status["mode"]))],
        1.0,
    );
    page.family(
        "subsumed_uptime_seconds",
        "gauge",
        "Seconds since the daemon began.",
    );
    page.sample("subsumed_uptime_seconds", &[], number(&status["time_s"]));
    for (name, key, about) in [
        ("subsumed_beats", "beats", "Beats that ran."),
        (
            "subsumed_overruns",
            "overruns",
            "Beats that ended after the next was due.",
        ),
        (
            "subsumed_skipped_beats",
            "skipped",
            "Beats left out because of an overrun.",
        ),
        (
            "subsumed_lost_samples",
            "lost_samples",
            "Latencies that were measured but not recorded.",
        ),
    ] {
        page.family(name, "counter", about);
        for layer in &threads {
            page.sample(
                &format!("{name}_total"),
                &[("layer", word(&layer["name"]))],
                number(&layer[key]),
            );
        }
    }
    for (name, key, sum, about) in [
        (
            "subsumed_latency_seconds",
            "histogram",
            "latency_sum_us",
            "From a beat being due to it running.",
        ),
        (
            "subsumed_step_seconds",
            "step_histogram",
            "step_sum_us",
            "From a beat running to its end.",
        ),
    ] {
        page.unit_family(name, "histogram", "seconds", about);
        for layer in &threads {
            page.histogram(
                name,
                word(&layer["name"]),
                &layer[key],
                number(&layer[sum]) * 1e-6,
            );
        }
    }
    page.wires_and_taps(status);
    page.family("subsumed_halted", "gauge", "Whether the body is halted.");
    page.sample(
        "subsumed_halted",
        &[],
        f64::from(u8::from(status["halt"]["halted"] == true)),
    );
    page.family(
        "subsumed_halts",
        "counter",
        "How often the body was halted, by cause.",
    );
    // Those that never came up as well: an alert needs a counter that is there before it counts.
    for (_, cause) in Causes::named() {
        let counts = status["halt"]["counts"].as_array().into_iter().flatten();
        let counted = counts
            .filter(|c| c["cause"] == cause)
            .map(|c| number(&c["count"]));
        page.sample("subsumed_halts_total", &[("cause", cause)], counted.sum());
    }
    page.family(
        "subsumed_attached_layers",
        "gauge",
        "Layer processes that are attached.",
    );
    page.sample("subsumed_attached_layers", &[], attached.len() as f64);
    page.family(
        "subsumed_layer_attached",
        "gauge",
        "1 for each layer process that is attached.",
    );
    for layer in &attached {
        let level = layer["level"].to_string();
        page.sample(
            "subsumed_layer_attached",
            &[("layer", word(&layer["name"])), ("level", &level)],
            1.0,
        );
    }
    page.family(
        "subsumed_real_time_allocations",
        "counter",
        "Allocations on real-time threads; 0 if all is well.",
    );
    page.sample(
        "subsumed_real_time_allocations_total",
        &[],
        number(&status["real_time_allocations"]),
    );
    page.text.push_str("# EOF\n");
    page.text
}

fn list<'v>(value: &'v Value, key: &str) -> impl Iterator<Item = &'v Value> {
    value[key].as_array().into_iter().flatten()
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

struct Page {
    creature: String,
    text: String,
}

impl Page {
    fn family(&mut self, name: &str, kind: &str, about: &str) {
        let _ = writeln!(self.text, "# TYPE {name} {kind}\n# HELP {name} {about}");
    }

    fn unit_family(&mut self, name: &str, kind: &str, unit: &str, about: &str) {
        let _ = writeln!(
            self.text,
            "# TYPE {name} {kind}\n# UNIT {name} {unit}\n# HELP {name} {about}"
        );
    }

    fn sample(&mut self, name: &str, labels: &[(&str, &str)], value: f64) {
        let _ = write!(self.text, "{name}{{creature=\"{}\"", escaped(&self.creature));
        for (label, value) in labels {
            let _ = write!(self.text, ",{label}=\"{}\"", escaped(value));
        }
        // A sum of nothing is -0: adding 0 takes the sign away.
        let _ = writeln!(self.text, "}} {}", value + 0.0);
    }

    /// `bars` are pairs of an upper bound in microseconds, doubling from 1, and a count.
    fn histogram(&mut self, name: &str, layer: &str, bars: &Value, sum: f64) {
        let bars: Vec<(f64, f64)> = bars
            .as_array()
            .into_iter()
            .flatten()
            .map(|bar| (number(&bar[0]), number(&bar[1])))
            .collect();
        let bucket = format!("{name}_bucket");
        for k in 0..BUCKETS {
            let upper = f64::from(1_u32 << k);
            let below: f64 = bars
                .iter()
                .filter(|(bound, _)| *bound <= upper)
                .map(|(_, n)| n)
                .sum();
            self.sample(
                &bucket,
                &[("layer", layer), ("le", &format!("{:?}", upper * 1e-6))],
                below,
            );
        }
        let all: f64 = bars.iter().map(|(_, n)| n).sum();
        self.sample(&bucket, &[("layer", layer), ("le", "+Inf")], all);
        self.sample(&format!("{name}_count"), &[("layer", layer)], all);
        self.sample(&format!("{name}_sum"), &[("layer", layer)], sum);
    }

    fn wires_and_taps(&mut self, status: &Value) {
        self.family("subsumed_wire_messages", "counter", "Messages written to a wire.");
        for wire in list(status, "wires") {
            let labels = [("wire", word(&wire["wire"]))];
            self.sample("subsumed_wire_messages_total", &labels, number(&wire["messages"]));
        }
        for (name, key, about) in [
            (
                "subsumed_tap_delivered",
                "delivered",
                "Messages of a tap that took effect.",
            ),
            (
                "subsumed_tap_rejected",
                "rejected",
                "Messages that a tap's window kept out.",
            ),
            (
                "subsumed_tap_faults",
                "faults",
                "Messages of a tap that were none.",
            ),
        ] {
            self.family(name, "counter", about);
            for tap in list(status, "taps") {
                self.sample(&format!("{name}_total"), &tap_labels(tap), number(&tap[key]));
            }
        }
        self.family("subsumed_tap_holds", "gauge", "Whether a tap's window is open.");
        for tap in list(status, "taps") {
            self.sample(
                "subsumed_tap_holds",
                &tap_labels(tap),
                f64::from(u8::from(tap["holds"] == true)),
            );
        }
    }
}

fn tap_labels(tap: &Value) -> [(&str, &str); 3] {
    [
        ("from", word(&tap["from"])),
        ("to", word(&tap["to"])),
        ("kind", word(&tap["kind"])),
    ]
}

/// A label's value as the format wants it.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::collections::{BTreeMap, BTreeSet};

    fn status() -> Value {
        json!({
            "creature": "al\"len", "mode": "best effort", "time_s": 12.5, "real_time_allocations": 0,
            "layers": [
                {"name": "avoid", "level": 0, "attached": false, "beats": 1000, "overruns": 2, "skipped": 1,
                 "lost_samples": 0, "histogram": [[1.0, 10], [2.0, 20], [4.0, 0], [3e9, 1]], "latency_sum_us": 55.0,
                 "step_histogram": [[1.0, 31]], "step_sum_us": 20.0},
                {"name": "wander", "level": 1, "attached": true, "pid": 4},
            ],
            "wires": [{"wire": "turn.rate", "messages": 77}],
            "taps": [{"from": "avoid.heading", "to": "turn.heading", "kind": "suppress", "holds": true,
                      "delivered": 5, "rejected": 6, "faults": 0}],
            "halt": {"halted": true, "counts": [{"cause": "emergency stop", "count": 3}, {"cause": "start", "count": 1}]},
        })
    }

    /// A reader of the format as strict as its specification: families in one piece, TYPE and HELP before samples,
    /// suffixes as the type wants them, sound labels and numbers, buckets that only grow, EOF at the end.
    fn check(text: &str) -> BTreeMap<String, f64> {
        let body = text.strip_suffix("# EOF\n").expect("the text ends with # EOF");
        let (mut types, mut samples) = (BTreeMap::new(), BTreeMap::new());
        let (mut family, mut helped) = (String::new(), BTreeSet::new());
        for line in body.lines() {
            if let Some(rest) = line.strip_prefix("# ") {
                let mut words = rest.splitn(3, ' ');
                let (what, name, more) = (
                    words.next().unwrap(),
                    words.next().unwrap(),
                    words.next().unwrap(),
                );
                match what {
                    "TYPE" => {
                        assert!(
                            types.insert(name.to_string(), more.to_string()).is_none(),
                            "{name} twice"
                        );
                        family = name.into();
                    }
                    "HELP" => assert!(name == family && helped.insert(name.to_string()), "{line}"),
                    "UNIT" => assert!(name == family && name.ends_with(more), "{line}"),
                    _ => panic!("{line}"),
                }
                continue;
            }
            let (series, value) = line.rsplit_once(' ').expect("a sample has a value");
            let value: f64 = value.parse().expect("a value is a number");
            let (name, labels) = series.split_once('{').expect("every sample names its creature");
            assert!(
                labels.starts_with("creature=\"al\\\"len\"") && labels.ends_with('}'),
                "{line}"
            );
            let suffix = name
                .strip_prefix(family.as_str())
                .expect("samples stand below their family");
            let allowed: &[&str] = match types[&family].as_str() {
                "counter" => &["_total"],
                "histogram" => &["_bucket", "_count", "_sum"],
                "info" => &["_info"],
                "gauge" => &[""],
                other => panic!("type {other}"),
            };
            assert!(allowed.contains(&suffix), "{line} in a {}", types[&family]);
            assert!(
                samples.insert(series.to_string(), value).is_none(),
                "{series} twice"
            );
        }
        assert!(
            types.keys().all(|name| helped.contains(name)),
            "every family has its HELP"
        );
        samples
    }

    #[test]
    fn the_text_is_open_metrics() {
        let samples = check(&text(&status()));
        let creature = "creature=\"al\\\"len\"";
        assert_eq!(
            samples[&format!("subsumed_beats_total{{{creature},layer=\"avoid\"}}")],
            1000.0
        );
        assert_eq!(
            samples[&format!("subsumed_halts_total{{{creature},cause=\"emergency stop\"}}")],
            3.0
        );
        assert_eq!(
            samples[&format!("subsumed_halts_total{{{creature},cause=\"vital layer late\"}}")],
            0.0,
            "what never came up is counted from the start"
        );
        assert_eq!(samples[&format!("subsumed_attached_layers{{{creature}}}")], 1.0);
        assert_eq!(samples[&format!("subsumed_halted{{{creature}}}")], 1.0);
        assert_eq!(
            samples[&format!("subsumed_wire_messages_total{{{creature},wire=\"turn.rate\"}}")],
            77.0
        );
        assert_eq!(
            samples[&format!("subsumed_latency_seconds_count{{{creature},layer=\"avoid\"}}")],
            31.0
        );
    }

    #[test]
    fn buckets_add_up_and_stay_the_same() {
        let text = text(&status());
        let buckets: Vec<(&str, f64)> = text
            .lines()
            .filter(|l| l.starts_with("subsumed_latency_seconds_bucket"))
            .map(|l| {
                let bound = l.split("le=\"").nth(1).unwrap().split('"').next().unwrap();
                (bound, l.rsplit_once(' ').unwrap().1.parse().unwrap())
            })
            .collect();
        assert_eq!(buckets.len(), BUCKETS as usize + 1);
        assert!(
            buckets.windows(2).all(|pair| pair[0].1 <= pair[1].1),
            "{buckets:?}"
        );
        assert_eq!(buckets[0], ("1e-6", 10.0));
        assert_eq!(buckets[1].1, 30.0);
        assert_eq!(buckets[BUCKETS as usize], ("+Inf", 31.0));
    }
}
