//! The gate, for every pair of beats that there can be, against a model that looks back at everything it was told.
//!
//! Must never share a line of reasoning with the gate: the model keeps the whole history and no state.

use super::*;

const STALE: Span = Span::millis(100);
const HOLD: Span = Span::millis(60);

/// What is told in one beat, as choices of a few values each.
fn beats(now: Time) -> Vec<Seen> {
    let mut all = Vec::new();
    let commands = [None, Some(now), Some(now - STALE), Some(now - Span(STALE.0 + 1))];
    let reflexes = [None, Some(now), Some(now - Span(HOLD.0 - 1)), Some(now - HOLD)];
    let latched = [Causes::NONE, Causes::EMERGENCY, Causes::SHUTDOWN];
    // What others see standing: one that latches, one that ends with its cause.
    let standing = [Causes::NONE, Causes::VITAL, Causes::STALE];
    for oldest_command in commands {
        for reflex in reflexes {
            for (latched, standing) in latched.iter().flat_map(|l| standing.map(|s| (*l, s))) {
                for bits in 0..8_u8 {
                    let bit = |k: u8| bits >> k & 1 == 1;
                    all.push(Seen {
                        now,
                        oldest_command,
                        unsound: bit(0),
                        reflex,
                        vital_began: bit(1),
                        standing,
                        latched,
                        reset: bit(2),
                    });
                }
            }
        }
    }
    all
}

fn fresh(seen: &Seen) -> bool {
    seen.oldest_command
        .is_some_and(|stamp| seen.now.since(stamp) <= STALE)
}

/// What the gate must say after `history`, from the specification alone.
fn model(history: &[Seen]) -> (Causes, Passage) {
    let last = history.last().expect("there was a beat");
    let first_good = history.iter().position(|s| fresh(s) && s.vital_began);
    let mut causes = Causes::NONE;
    if first_good.is_none() {
        causes = causes.with(Causes::START);
    } else if !fresh(last) {
        causes = causes.with(Causes::STALE);
    }
    if history
        .iter()
        .any(|s| s.unsound && last.now.since(s.now) <= STALE)
    {
        causes = causes.with(Causes::UNSOUND);
    }
    if last.reflex.is_some_and(|stamp| last.now.since(stamp) < HOLD) {
        causes = causes.with(Causes::REFLEX);
    }
    // What was latched before a reset is gone; what stands in the beat of the reset is not.
    let from = history.iter().rposition(|s| s.reset).unwrap_or(0);
    for (n, seen) in history.iter().enumerate().skip(from) {
        causes = causes.with(seen.latched);
        if seen.standing == Causes::VITAL && first_good.is_some_and(|good| good <= n) {
            causes = causes.with(Causes::VITAL);
        }
    }
    if last.standing == Causes::STALE {
        causes = causes.with(Causes::STALE);
    }
    let passage = if causes == Causes::NONE {
        Passage::Open
    } else if causes == Causes::REFLEX {
        Passage::NoForward
    } else {
        Passage::Closed
    };
    (causes, passage)
}

#[test]
fn every_pair_of_beats_is_decided_as_the_specification_says() {
    let (one, two) = (Time(1_000_000_000), Time(1_020_000_000));
    let seconds = beats(two);
    let mut opened = 0;
    for first in beats(one) {
        let mut gate = Gate::new(STALE, HOLD);
        assert_eq!(gate.decide(&first), model(&[first]), "{first:?}");
        for second in &seconds {
            let mut gate = gate;
            let decided = gate.decide(second);
            assert_eq!(decided, model(&[first, *second]), "{first:?} {second:?}");
            opened += u32::from(decided.1 == Passage::Open);
        }
    }
    assert!(opened > 1_000, "the gate opens at all: {opened}");
}

#[test]
fn every_third_beat_after_a_good_one_is_too() {
    let times = [1_000_000_000, 1_050_000_000, 1_120_000_000].map(Time);
    let good = Seen {
        oldest_command: Some(times[0]),
        ..beats(times[0])[2]
    };
    assert!(good.vital_began && !good.unsound);
    for second in beats(times[1]).into_iter().step_by(3) {
        for third in beats(times[2]) {
            let mut gate = Gate::new(STALE, HOLD);
            gate.decide(&good);
            gate.decide(&second);
            assert_eq!(
                gate.decide(&third),
                model(&[good, second, third]),
                "{second:?} {third:?}"
            );
        }
    }
}
