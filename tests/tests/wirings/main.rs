//! Random wirings of up to twenty modules, random taps and random histories of messages, compared message by
//! message with a model of its own.
//!
//! Must never share a line of reasoning with the sources.
//!
//! - [`drawn`]: what is tried, and the creature file of it
//! - [`model`]: what the rules say, from every message there ever was

mod drawn;
mod model;

use std::collections::BTreeMap;

use daemon::virtual_run::{BEGIN, Options, Stimulus, VirtualRun};
use ipc::clock::{Span, Time};
use ipc::message::WORDS_MAX;
use ipc::wiring::{Source, check};
use proptest::prelude::*;
use scenario::kinds;

use drawn::{Case, case};
use model::{Account, expected};

/// Cases tried: three seconds of a debug build.
const CASES: u32 = 2000;

/// What really came of `case`.
fn came(case: &Case, watched: bool, shuffle: Option<u64>) -> (Account, u64) {
    let text = case.creature();
    let kinds = kinds::kinds();
    let creature = check::creature(&Source::new("drawn.toml", &text), &kinds);
    let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}\n{text}"));
    let wires: Vec<String> = (0..case.modules.len()).map(drawn::port).collect();
    let ears = (0..case.modules.len()).filter(|&m| case.modules[m].source.is_some());
    let inputs: Vec<String> = ears.map(drawn::port).collect();
    let options = Options {
        keep: Some(wires.clone()),
        inputs: if watched { inputs.clone() } else { Vec::new() },
        shuffle,
        ..Options::default()
    };
    let mut run = VirtualRun::with(creature, &kinds, &options);
    let mut moments: BTreeMap<u64, Vec<Stimulus>> = BTreeMap::new();
    for put in &case.puts {
        let mut words = [0.0; WORDS_MAX];
        words[0] = put.value;
        let stimulus = Stimulus::Put(drawn::port(put.module), words);
        moments.entry(put.at).or_default().push(stimulus);
    }
    for (at, stimuli) in moments {
        run.advance_to(BEGIN + Span(at));
        run.moment(BEGIN + Span(at), &stimuli);
    }
    run.advance_to(BEGIN + Span(drawn::END));
    run.settle();
    let plain = |messages: &[(Time, [f64; WORDS_MAX])]| -> Vec<(u64, f64)> {
        let one = |(stamp, words): &(Time, [f64; WORDS_MAX])| (stamp.since(BEGIN).0, words[0]);
        messages.iter().map(one).collect()
    };
    let log = run.log().expect("it keeps one");
    let mut account = Account::default();
    for port in &wires {
        account.written.push(plain(log.messages(port)));
        account.delivered.push(plain(run.delivered(port)));
    }
    for tap in &case.taps {
        let view = run.tap(&drawn::port(tap.from), &drawn::port(tap.to));
        let counts = view.expect("the tap is there").counts;
        account.taps.push((counts.delivered, counts.rejected));
        assert_eq!(counts.faults, 0);
    }
    (account, log.hash())
}

fn agrees(case: &Case) {
    let wanted = expected(case);
    let (account, hash) = came(case, true, None);
    for (module, (came, wanted)) in account.written.iter().zip(&wanted.written).enumerate() {
        assert_eq!(came, wanted, "written to m{module}.value\n{}", case.creature());
    }
    for (module, (came, wanted)) in account.delivered.iter().zip(&wanted.delivered).enumerate() {
        assert_eq!(came, wanted, "delivered to m{module}.value\n{}", case.creature());
    }
    for (tap, (came, wanted)) in account.taps.iter().zip(&wanted.taps).enumerate() {
        let tap = &case.taps[tap];
        assert_eq!(
            came,
            wanted,
            "delivered, rejected at {tap:?}\n{}",
            case.creature()
        );
    }
    // Unwatched inputs are looked at only when they have to be, and modules step in another order.
    let (unwatched, same) = came_unwatched(case);
    assert_eq!(
        (unwatched.written, same),
        (account.written, hash),
        "unwatched, shuffled"
    );
    assert_eq!(unwatched.taps, account.taps, "unwatched, shuffled");
}

fn came_unwatched(case: &Case) -> (Account, u64) {
    came(case, false, Some(3))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_message_fares_as_the_rules_say(case in case()) {
        agrees(&case);
    }
}

#[test]
fn what_is_drawn_is_worth_drawing() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let (mut written, mut rejected, mut largest) = (0, 0, 0);
    for _ in 0..100 {
        let case = case().new_tree(&mut runner).expect("a case").current();
        let account = expected(&case);
        written += account.written.iter().map(Vec::len).sum::<usize>();
        rejected += account.taps.iter().map(|t| t.1).sum::<u64>();
        largest = largest.max(case.modules.len());
    }
    assert!(written > 5_000, "{written} messages");
    assert!(rejected > 300, "{rejected} rejected or dropped");
    assert_eq!(largest, drawn::MODULES_MAX);
}
