//! Suppressors and inhibitors on one wire, and taps on taps.
//!
//! Must never let one kind of tap stand in for the other: inhibition is at the output, suppression at an input.

use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wire::{Outlet, Page, Register};

use crate::model::{self, Input};
use crate::rig::{KINDS, any, choices, end, histories, said, suppressors, words, wrote};

/// An output that an inhibitor stands on, and the input it feeds, which a suppressor stands before.
/// Sources: 0 the module, 1 the inhibitor, 2 the suppressor.
#[test]
fn an_inhibitor_and_a_suppressor_on_one_wire_every_history() {
    for history in histories(3, 4) {
        for taus in choices(2, &[1, 2, 3]) {
            for stride in 1..=3 {
                inhibit_and_suppress(&history, taus[0], taus[1], stride);
            }
        }
    }
}

pub(crate) fn inhibit_and_suppress(history: &[u32], inhibit: u64, suppress: u64, stride: u64) {
    for kind in KINDS {
        inhibit_and_suppress_kind(history, inhibit, suppress, stride, kind);
    }
}

fn inhibit_and_suppress_kind(history: &[u32], inhibit: u64, suppress: u64, stride: u64, kind: Kind) {
    let page = Page::in_memory(3);
    let mut register = Register::new(any(kind), page.reader(0, kind));
    register.suppress(end(&page, kind, 2, suppress, 1, 0)).unwrap();
    let mut outlet = Outlet::new(page.writer(0, kind).unwrap());
    outlet.inhibit(end(&page, kind, 1, inhibit, 1, 0)).unwrap();
    let mut inhibitor = page.writer(1, kind).unwrap();
    let mut suppressor = page.writer(2, kind).unwrap();
    let mut input = Input::new(&suppressors(&[1], &[suppress]));
    let (mut inhibiting, mut emitted, mut dropped) = (Vec::new(), 0, 0);
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        if wrote(row, 1) {
            inhibiting.push(now);
            inhibitor.write(Time(now), &words(now, 1));
        }
        if wrote(row, 2) {
            suppressor.write(Time(now), &words(now, 1));
        }
        let open = !model::rejects(&inhibiting, inhibit, now);
        let emits = wrote(row, 0) && open;
        if wrote(row, 0) {
            outlet.stage(words(now, 0));
            emitted += u64::from(open);
            dropped += u64::from(!open);
        }
        let why = format!("{history:?} inhibit {inhibit} suppress {suppress} {kind} tick {now}");
        assert_eq!(outlet.commit(Time(now), |_| panic!("{why}")), emits, "{why}");
        input.tick(now, |s| if s == 0 { emits } else { wrote(row, 2) });
        if now % stride == stride - 1 {
            register.gather(Time(now), |_| panic!("{why}"));
            assert_eq!(said(register.held(), kind), input.held(), "{why}");
        }
    }
    let counts = outlet.counts();
    assert_eq!((counts.emitted, counts.inhibited), (emitted, dropped));
    let tap = outlet.taps().next().unwrap();
    assert_eq!(tap.counts.delivered, inhibiting.len() as u64);
    assert_eq!(tap.counts.rejected, dropped);
}

/// A suppressor whose own wire is inhibited and suppressed: what comes through all that is what its tap
/// delivers. Sources: 0 the existing wire, 1 the module of the tap, 2 an inhibitor on that module's output,
/// 3 a suppressor on the way from there to the tap.
#[test]
fn a_tap_on_a_tap_every_history() {
    for history in histories(4, 4) {
        for taus in [[1, 1, 1], [3, 1, 1], [1, 3, 1], [1, 1, 3], [2, 1, 2], [3, 2, 2]] {
            tap_on_tap(&history, taus[0], taus[1], taus[2]);
        }
    }
}

pub(crate) fn tap_on_tap(history: &[u32], suppress: u64, inhibit: u64, suppress_tap: u64) {
    for kind in KINDS {
        tap_on_tap_of_kind(history, suppress, inhibit, suppress_tap, kind);
    }
}

fn tap_on_tap_of_kind(history: &[u32], suppress: u64, inhibit: u64, suppress_tap: u64, kind: Kind) {
    const EXISTING: usize = 0;
    const MODULE: usize = 1;
    const TAP: usize = 4; // what a relay makes of the module's wire
    let page = Page::in_memory(5);
    let mut existing = page.writer(EXISTING, kind).unwrap();
    let mut outlet = Outlet::new(page.writer(MODULE, kind).unwrap());
    let mut inhibitor = page.writer(2, kind).unwrap();
    let mut over_tap = page.writer(3, kind).unwrap();
    let mut relayed = Outlet::new(page.writer(TAP, kind).unwrap());
    outlet.inhibit(end(&page, kind, 2, inhibit, 2, 0)).unwrap();
    let mut relay = Register::new(any(kind), page.reader(MODULE, kind));
    relay.suppress(end(&page, kind, 3, suppress_tap, 2, 0)).unwrap();
    let mut register = Register::new(any(kind), page.reader(EXISTING, kind));
    register.suppress(end(&page, kind, TAP, suppress, 1, 0)).unwrap();

    let mut inhibiting = Vec::new();
    let mut line = Input::new(&suppressors(&[2], &[suppress_tap]));
    let mut input = Input::new(&suppressors(&[1], &[suppress]));
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        let why = format!("{history:?} {suppress} {inhibit} {suppress_tap} {kind} tick {now}");
        if wrote(row, 0) {
            existing.write(Time(now), &words(now, 0));
        }
        if wrote(row, 1) {
            outlet.stage(words(now, 1));
        }
        if wrote(row, 2) {
            inhibiting.push(now);
            inhibitor.write(Time(now), &words(now, 1));
        }
        if wrote(row, 3) {
            over_tap.write(Time(now), &words(now, 1));
        }
        outlet.commit(Time(now), |_| panic!("{why}"));
        relay.gather(Time(now), |_| panic!("{why}"));
        if relay.arrived() {
            relayed.stage(relay.held().unwrap().1);
        }
        relayed.commit(Time(now), |_| panic!("{why}"));
        register.gather(Time(now), |_| panic!("{why}"));

        let emits = wrote(row, 1) && !model::rejects(&inhibiting, inhibit, now);
        line.tick(now, |s| if s == 0 { emits } else { wrote(row, 3) });
        let taps = line.held().is_some_and(|(t, _)| t == now);
        input.tick(now, |s| if s == 0 { wrote(row, 0) } else { taps });
        assert_eq!(said(register.held(), kind), input.held(), "{why}");
    }
}
