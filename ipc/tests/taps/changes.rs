//! Taps that come, go, or are heard late, and registers that are reset.
//!
//! Must never find a message alive that was rejected before.

use ipc::clock::Time;
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::{Outlet, Page, Register, Writer};

use crate::model::{self, Input, Suppressor};
use crate::rig::{KINDS, Real, any, choices, end, histories, said, suppressors, words, writers, wrote};

/// A tap that is released goes on rejecting until its window has run out, says nothing more, and leaves
/// nothing behind.
#[test]
fn a_released_tap_runs_out_and_revives_nothing() {
    for history in histories(3, 4) {
        let history = [&history[..], &[0, 1, 0, 0, 1]].concat();
        for taus in choices(2, &[1, 3, 5]) {
            for released in 1..=2 {
                for at in 0..4 {
                    let taps = suppressors(&[1, 2], &taus);
                    KINDS
                        .iter()
                        .for_each(|&kind| release(&history, &taps, released, at, kind));
                }
            }
        }
    }
}

fn release(history: &[u32], taps: &[Suppressor], released: usize, at: u64, kind: Kind) {
    let page = Page::in_memory(3);
    let mut writers = writers(&page, kind);
    let mut register = Register::new(any(kind), page.reader(0, kind));
    for (k, s) in taps.iter().enumerate() {
        let end = end(&page, kind, k + 1, s.tau, s.level, k as u32 + 1);
        register.suppress(end).unwrap();
    }
    let mut expected = Input::new(taps);
    let (mut newest, mut left) = (None, None);
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        if now == at {
            register.release(released as u32);
        }
        let heard = |s| wrote(row, s) && (s != released || now < at);
        if heard(released) {
            newest = Some(now);
        }
        expected.tick(now, heard);
        (0..3)
            .filter(|&s| wrote(row, s))
            .for_each(|s| writers[s].write(Time(now), &words(now, s)));
        register.gather(Time(now), |end| {
            assert_eq!(end.plug as usize, released);
            assert_eq!(left.replace(now), None, "a tap leaves once");
        });
        let why = format!("{taps:?} {history:?} tap {released} released at {at}, {kind}, tick {now}");
        assert_eq!(said(register.held(), kind), expected.held(), "{why}");
    }
    let run_out = newest.map_or(at, |t| at.max(t + taps[released - 1].tau));
    let seen = (run_out < history.len() as u64).then_some(run_out);
    assert_eq!(left, seen, "{taps:?} {history:?} {released} {at}");
    assert_eq!(register.taps().count(), if seen.is_some() { 1 } else { 2 });
}

#[test]
fn a_released_inhibitor_runs_out() {
    KINDS.into_iter().for_each(release_inhibitor);
}

fn release_inhibitor(kind: Kind) {
    let page = Page::in_memory(2);
    let mut outlet = Outlet::new(page.writer(0, kind).unwrap());
    let mut inhibitor = page.writer(1, kind).unwrap();
    outlet.inhibit(end(&page, kind, 1, 10, 1, 7)).unwrap();
    inhibitor.write(Time(100), &words(100, 1));
    let mut left = Vec::new();
    for now in 100..115 {
        outlet.stage(words(now, 0));
        let wrote = outlet.commit(Time(now), |end| left.push((now, end.plug)));
        assert_eq!(wrote, now >= 110, "{now}");
        outlet.release(7);
        inhibitor.write(Time(now), &words(now, 1));
    }
    assert_eq!(left, [(110, 7)]);
}

/// What a tap said before it was joined is not heard: the wire was not tapped then.
#[test]
fn a_joined_tap_starts_with_an_empty_past() {
    for history in histories(2, 6) {
        for tau in [1, 3, 6] {
            for at in 0..6 {
                KINDS.iter().for_each(|&kind| join_late(&history, tau, at, kind));
            }
        }
    }
}

fn join_late(history: &[u32], tau: u64, at: u64, kind: Kind) {
    let page = Page::in_memory(3);
    let mut writers = writers(&page, kind);
    let mut outlet = Outlet::new(writers.pop().unwrap());
    let mut register = Register::new(any(kind), page.reader(0, kind));
    let mut expected = Input::new(&suppressors(&[1], &[tau]));
    let mut inhibiting = Vec::new();
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        (0..2)
            .filter(|&s| wrote(row, s))
            .for_each(|s| writers[s].write(Time(now), &words(now, s)));
        if now == at {
            register.suppress(end(&page, kind, 1, tau, 1, 0)).unwrap();
            outlet.inhibit(end(&page, kind, 1, tau, 1, 0)).unwrap();
        }
        let heard = wrote(row, 1) && now > at;
        if heard {
            inhibiting.push(now);
        }
        expected.tick(now, |s| if s == 0 { wrote(row, 0) } else { heard });
        register.gather(Time(now), |_| panic!("nobody told a tap to go"));
        let why = format!("{history:?} τ {tau} joined at {at}, {kind}, tick {now}");
        assert_eq!(said(register.held(), kind), expected.held(), "{why}");
        outlet.stage(words(now, 0));
        let emits = !model::rejects(&inhibiting, tau, now);
        assert_eq!(
            outlet.commit(Time(now), |_| panic!("nobody told a tap to go")),
            emits,
            "{why}"
        );
    }
}

/// Messages of other processes may be seen later than those of later stamps. The register then ends where
/// it would have with all of them seen in time.
#[test]
fn messages_seen_late_count_from_their_stamps() {
    for history in histories(3, 4) {
        for taus in choices(2, &[1, 2, 4]) {
            for late in choices(3, &[0, 1, 2]) {
                seen_late(&history, &suppressors(&[1, 2], &taus), &late);
            }
        }
    }
}

pub(crate) fn seen_late(history: &[u32], taps: &[Suppressor], late: &[u64]) {
    for kind in KINDS {
        seen_late_of_kind(history, taps, late, kind);
    }
}

fn seen_late_of_kind(history: &[u32], taps: &[Suppressor], late: &[u64], kind: Kind) {
    let mut real = Real::new(taps, kind);
    let mut visible: Vec<Vec<u64>> = vec![Vec::new(); taps.len() + 1];
    for now in 0..history.len() as u64 + 2 {
        for source in 0..=taps.len() {
            let Some(stamp) = now.checked_sub(late[source]) else {
                continue;
            };
            if history.get(stamp as usize).is_some_and(|&row| wrote(row, source)) {
                visible[source].push(stamp);
                real.write(stamp, source);
            }
        }
        real.gather(now);
        let mut expected = Input::new(taps);
        (0..=now).for_each(|t| expected.tick(t, |s| visible[s].contains(&t)));
        assert_eq!(
            real.held(),
            expected.held(),
            "{taps:?} {history:?} {late:?} {kind} tick {now}"
        );
    }
}

#[test]
fn a_reset_register_forgets_and_revives_nothing() {
    for kind in KINDS {
        let mut real = Real::new(&suppressors(&[1], &[10]), kind);
        real.write(0, 1);
        real.write(1, 0);
        real.gather(1);
        real.register.clear();
        for now in 2..20 {
            real.gather(now);
            assert_eq!(real.register.held(), None);
            assert!(!real.register.arrived());
        }
    }
}

/// What is no message is counted and changes nothing.
#[test]
fn a_message_that_is_none_is_a_fault() {
    let no_bits = [0.5, -1.0, 2.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300];
    let no_numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e9 + 1.0, -1e9 - 1.0];
    let bad = [
        (Kind::Bit, &no_bits[..]),
        (Kind::Number, &no_numbers[..]),
        (Kind::Vector, &no_numbers[..]),
    ];
    for (kind, bad) in bad {
        let page = Page::in_memory(2);
        let mut writers = writers(&page, kind);
        let mut register = Register::new(any(kind), page.reader(0, kind));
        let tap = end(&page, kind, 1, 10, 1, 0);
        let gauge = tap.gauge.clone();
        let mut now = 0;
        let mut gather = |register: &mut Register, writer: &mut Writer, word: f64| {
            now += 1;
            writer.write(Time(now), &[word; WORDS_MAX]);
            register.gather(Time(now), |_| panic!("nobody told a tap to go"));
            register.held().map(|(_, words)| words[0])
        };
        assert_eq!(gather(&mut register, &mut writers[0], 1.0), Some(1.0), "{kind}");
        for &word in bad {
            assert_eq!(
                gather(&mut register, &mut writers[0], word),
                Some(1.0),
                "{kind} {word}"
            );
            assert!(!register.arrived(), "{kind} {word}");
        }
        assert_eq!(register.counts().faults, bad.len() as u64, "{kind}");
        register.suppress(tap).unwrap();
        for &word in bad {
            assert_eq!(
                gather(&mut register, &mut writers[1], word),
                Some(1.0),
                "{kind} {word}"
            );
        }
        assert_eq!(gauge.counts().faults, bad.len() as u64, "{kind}");
        assert_eq!(gather(&mut register, &mut writers[1], 0.0), Some(0.0), "{kind}");
        assert_eq!(
            gather(&mut register, &mut writers[0], 1.0),
            Some(0.0),
            "{kind}: rejected"
        );
        let counts = register.counts();
        assert_eq!((counts.faults, counts.rejected), (bad.len() as u64, 1), "{kind}");
    }
}
