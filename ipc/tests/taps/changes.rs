//! Taps that come, go, or are heard late, and registers that are reset.
//!
//! Must never find a message alive that was rejected before.

use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wire::{Outlet, Page, Register};

use crate::model::{self, Input, Suppressor};
use crate::rig::{ANY, Real, choices, end, histories, said, suppressors, words, writers, wrote};

/// A tap that is released goes on rejecting until its window has run out, says nothing more, and leaves
/// nothing behind.
#[test]
fn a_released_tap_runs_out_and_revives_nothing() {
    for history in histories(3, 4) {
        let history = [&history[..], &[0, 1, 0, 0, 1]].concat();
        for taus in choices(2, &[1, 3, 5]) {
            for released in 1..=2 {
                for at in 0..4 {
                    release(&history, &suppressors(&[1, 2], &taus), released, at);
                }
            }
        }
    }
}

fn release(history: &[u32], taps: &[Suppressor], released: usize, at: u64) {
    let page = Page::in_memory(3);
    let mut writers = writers(&page);
    let mut register = Register::new(ANY, page.reader(0, Kind::Vector));
    for (k, s) in taps.iter().enumerate() {
        let end = end(&page, k + 1, s.tau, s.level, k as u32 + 1);
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
        let why = format!("{taps:?} {history:?} tap {released} released at {at}, tick {now}");
        assert_eq!(said(register.held()), expected.held(), "{why}");
    }
    let run_out = newest.map_or(at, |t| at.max(t + taps[released - 1].tau));
    let seen = (run_out < history.len() as u64).then_some(run_out);
    assert_eq!(left, seen, "{taps:?} {history:?} {released} {at}");
    assert_eq!(register.taps().count(), if seen.is_some() { 1 } else { 2 });
}

#[test]
fn a_released_inhibitor_runs_out() {
    let page = Page::in_memory(2);
    let mut outlet = Outlet::new(page.writer(0, Kind::Vector).unwrap());
    let mut inhibitor = page.writer(1, Kind::Vector).unwrap();
    outlet.inhibit(end(&page, 1, 10, 1, 7)).unwrap();
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
                join_late(&history, tau, at);
            }
        }
    }
}

fn join_late(history: &[u32], tau: u64, at: u64) {
    let page = Page::in_memory(3);
    let mut writers = writers(&page);
    let mut outlet = Outlet::new(writers.pop().unwrap());
    let mut register = Register::new(ANY, page.reader(0, Kind::Vector));
    let mut expected = Input::new(&suppressors(&[1], &[tau]));
    let mut inhibiting = Vec::new();
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        (0..2)
            .filter(|&s| wrote(row, s))
            .for_each(|s| writers[s].write(Time(now), &words(now, s)));
        if now == at {
            register.suppress(end(&page, 1, tau, 1, 0)).unwrap();
            outlet.inhibit(end(&page, 1, tau, 1, 0)).unwrap();
        }
        let heard = wrote(row, 1) && now > at;
        if heard {
            inhibiting.push(now);
        }
        expected.tick(now, |s| if s == 0 { wrote(row, 0) } else { heard });
        register.gather(Time(now), |_| panic!("nobody told a tap to go"));
        let why = format!("{history:?} τ {tau} joined at {at}, tick {now}");
        assert_eq!(said(register.held()), expected.held(), "{why}");
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
    let mut real = Real::new(taps);
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
        let held = said(real.register.held());
        assert_eq!(held, expected.held(), "{taps:?} {history:?} {late:?} tick {now}");
    }
}

#[test]
fn a_reset_register_forgets_and_revives_nothing() {
    let mut real = Real::new(&suppressors(&[1], &[10]));
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
