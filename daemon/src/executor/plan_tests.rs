//! Which layers share a thread, at which priority, and what is refused.

use super::*;
use ipc::wiring::{Source, check};

/// Allen, with layers of these (period in ms, group) instead of its own.
fn creature(layers: &[(u64, Option<&str>)]) -> Creature {
    let kinds = crate::machine::kinds();
    let mut creature = check::creature(&Source::new("allen.toml", allen::CREATURE), &kinds).expect("sound");
    let pattern = creature.layers[0].clone();
    let layer = |(i, (period, group)): (usize, &(u64, Option<&str>))| Layer {
        name: format!("l{i}"),
        period: Span::millis(*period),
        group: group.map(str::to_string),
        priority: None,
        cpu: None,
        wake: Wake::Sleep,
        ..pattern.clone()
    };
    creature.layers = layers.iter().enumerate().map(layer).collect();
    creature
}

#[test]
fn priorities_are_rate_monotonic() {
    let threads = threads(&creature(&[(20, None), (5, None), (20, None), (100, None)])).unwrap();
    let schedules: Vec<Schedule> = threads.iter().map(|t| t.plan.schedule).collect();
    assert_eq!(
        schedules,
        [
            Schedule::Fifo(78),
            Schedule::Fifo(79),
            Schedule::Fifo(78),
            Schedule::Fifo(77)
        ]
    );
}

#[test]
fn the_file_has_the_last_word_on_a_priority() {
    let mut c = creature(&[(20, None), (5, None)]);
    c.layers[0].priority = Some(12);
    assert_eq!(threads(&c).unwrap()[0].plan.schedule, Schedule::Fifo(12));
}

#[test]
fn a_thousand_periods_still_have_a_priority() {
    let periods: Vec<(u64, Option<&str>)> = (1..=1000).map(|p| (p, None)).collect();
    let threads = threads(&creature(&periods)).unwrap();
    assert_eq!(threads[999].plan.schedule, Schedule::Fifo(1));
}

#[test]
fn layers_of_a_group_share_a_thread() {
    let threads = threads(&creature(&[
        (10, Some("a")),
        (20, None),
        (10, Some("a")),
        (10, Some("b")),
    ]))
    .unwrap();
    let layers: Vec<&[usize]> = threads.iter().map(|t| t.layers.as_slice()).collect();
    assert_eq!(layers, [&[0, 2][..], &[1], &[3]]);
    let names: Vec<&str> = threads.iter().map(|t| t.plan.name.as_str()).collect();
    assert_eq!(names, ["a", "l1", "l3"]);
}

#[test]
fn layers_of_a_group_must_agree() {
    let faults = threads(&creature(&[(10, Some("a")), (20, Some("a"))])).unwrap_err();
    assert_eq!(faults.len(), 1);
    assert!(
        faults[0].contains("\"l0\" and \"l1\" of group \"a\"") && faults[0].contains("same period"),
        "{faults:?}"
    );
}

#[test]
fn deadline_reserves_a_part_of_the_period_for_each() {
    let mut c = creature(&[(10, None), (20, None)]);
    c.executor.policy = Policy::Deadline;
    let threads = threads(&c).unwrap();
    let expected = Schedule::Deadline {
        runtime: Span::micros(1500),
        period: Span::millis(10),
    };
    assert_eq!(
        threads[0].plan.schedule, expected,
        "two layers, the motor unit and the watchdog share 60 %"
    );
}

fn spinning(c: &mut Creature, layer: usize, lead: Span, cpu: Option<usize>) {
    c.executor.spin_share_max = 0.1;
    c.layers[layer].wake = Wake::Spin(lead);
    c.layers[layer].cpu = cpu;
}

#[test]
fn spinning_within_the_share_is_granted() {
    let mut c = creature(&[(1, None), (1, None)]);
    spinning(&mut c, 0, Span::micros(60), Some(0));
    spinning(&mut c, 1, Span::micros(60), Some(1));
    let threads = threads(&c).unwrap();
    assert_eq!(threads[0].plan.wake, Wake::Spin(Span::micros(60)));
}

#[test]
fn spinning_beyond_the_share_is_refused_for_each_processor() {
    let mut c = creature(&[(1, None), (1, None)]);
    spinning(&mut c, 0, Span::micros(60), Some(1));
    spinning(&mut c, 1, Span::micros(60), Some(1));
    let faults = threads(&c).unwrap_err();
    assert_eq!(faults.len(), 2);
    assert!(
        faults[0].contains("12.0 % of processor 1") && faults[0].contains("10.0 %"),
        "{faults:?}"
    );
    spinning(&mut c, 1, Span::micros(60), None);
    assert!(
        threads(&c).is_err(),
        "a thread that is not bound may come to run there"
    );
}
