//! A short run of the lab, from the creature's threads to the files: every layer is measured in every respect.
//!
//! Must never judge a time: whether the host is quick is not the test's business.

use std::time::Duration;

use ipc::clock::Span;
use latency::load::Load;
use latency::report;
use latency::run::{Asked, run};
use serde_json::json;

#[test]
fn a_run_measures_every_layer_and_leaves_every_file() {
    let cpus = daemon::executor::host::processors();
    let cpu = *cpus.last().expect("there is a processor");
    let outcome = run(&Asked {
        load: Load::Idle,
        length: Duration::from_secs(1),
        cpu,
        other_cpu: cpus[0],
        priority: 70,
        period: Span::millis(5),
        spin: Span::micros(50),
        creature_spins: false,
        against: None,
        rounds: 0,
        to_the_end_of_doubt: false,
        round: Duration::from_secs(1),
        plant: None,
    })
    .expect("the run goes through");
    assert!(!outcome.interrupted && outcome.rounds.is_empty());
    for layer in ["sense", "relay", "act"] {
        for metric in ["wake-up", "step", "period-error", "response"] {
            let track = outcome
                .tracks
                .iter()
                .find(|t| t.of == layer && t.metric == metric);
            let track = track.unwrap_or_else(|| panic!("{layer} has no {metric}"));
            assert!(
                track.total.len() > 10,
                "{layer} {metric}: {} samples",
                track.total.len()
            );
            assert_eq!(track.intervals.len(), outcome.company.len());
        }
        let kept = outcome.kept.iter().find(|k| k.thread == layer).expect("counted");
        assert_eq!(kept.identity_faults, 0, "elapsed / period = beats + skipped");
        assert!(kept.beats > 10);
    }
    let age = outcome
        .tracks
        .iter()
        .find(|t| t.metric == "age")
        .expect("the actuator says how old its commands are");
    // From the sensor's beat to the actuator's lie two phases, but a sensor's beat may come late: what is sure is
    // that most commands took most of that way.
    let half = age.total.value_at_quantile(0.5);
    assert!(
        half >= 1_000_000,
        "half the ages are below {half} ns, less than their way"
    );

    let folder = std::env::temp_dir().join(format!("lab-idle-{}", std::process::id()));
    report::write(&folder, outcome.began, &outcome.tracks, &json!({}), "| a |\n").expect("written");
    for file in [
        "latency.hlog",
        "latency.svg",
        "latency.json",
        "latency.md",
        "relay.step.hgrm",
        "act.age.hgrm",
    ] {
        let text = std::fs::read_to_string(folder.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert!(!text.is_empty(), "{file} is empty");
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}
