//! Suppressors in series before one input: the pure function and the register against the model.
//!
//! Must never look at a register other than a daemon may: after any message, or only now and then.

use ipc::clock::{Span, Time};
use ipc::message::Kind;
use ipc::tap::{Window, emits, holder, passes};

use crate::model::{Input, Suppressor};
use crate::rig::{KINDS, Real, choices, histories, suppressors, wrote};

/// How often and in which order a register is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Look {
    /// After each message, the existing wire's first or last within a tick.
    EachMessage { taps_first: bool },
    /// At the end of every n-th tick.
    Every(u64),
}

pub(crate) const LOOKS: [Look; 5] = [
    Look::EachMessage { taps_first: false },
    Look::EachMessage { taps_first: true },
    Look::Every(1),
    Look::Every(2),
    Look::Every(3),
];

/// Steps a register through a history beside the model.
pub(crate) fn register_agrees(suppressors: &[Suppressor], history: &[u32], look: Look) {
    for kind in KINDS {
        register_of_kind_agrees(suppressors, history, look, kind);
    }
}

fn register_of_kind_agrees(suppressors: &[Suppressor], history: &[u32], look: Look, kind: Kind) {
    let mut expected = Input::new(suppressors);
    let mut real = Real::new(suppressors, kind);
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        expected.tick(now, |s| wrote(row, s));
        let mut sources = (0..=suppressors.len())
            .filter(|&s| wrote(row, s))
            .collect::<Vec<_>>();
        let looked = match look {
            Look::EachMessage { taps_first } => {
                if taps_first {
                    sources.reverse();
                }
                for source in sources {
                    real.write(now, source);
                    real.gather(now);
                }
                true
            }
            Look::Every(n) => {
                for source in sources {
                    real.write(now, source);
                }
                let due = now % n == n - 1;
                if due {
                    real.gather(now);
                }
                due
            }
        };
        if looked {
            assert_eq!(
                real.held(),
                expected.held(),
                "{suppressors:?} {history:?} {look:?} {kind} tick {now}"
            );
        }
        if let Look::Every(1) = look {
            let arrived = expected.delivered.last().is_some_and(|&(t, _)| t == now);
            assert_eq!(
                real.register.arrived(),
                arrived,
                "{suppressors:?} {history:?} tick {now}"
            );
        }
    }
    if let Look::Every(1) = look {
        counts_agree(&real, &expected, suppressors, history);
    }
}

/// Looked at every tick, a register misses nothing, and counts what the model counts.
fn counts_agree(real: &Real, expected: &Input, suppressors: &[Suppressor], history: &[u32]) {
    let of = |messages: &[(u64, usize)], source| messages.iter().filter(|m| m.1 == source).count() as u64;
    let counts = real.register.counts();
    let why = || format!("{suppressors:?} {history:?}");
    assert_eq!(counts.faults, 0, "{}", why());
    assert_eq!(counts.delivered, expected.delivered.len() as u64, "{}", why());
    assert_eq!(counts.rejected, of(&expected.rejected, 0), "{}", why());
    let mut by_taps = 0;
    for (k, gauge) in real.gauges.iter().enumerate() {
        let counts = gauge.counts();
        assert_eq!(counts.faults, 0, "{}", why());
        assert_eq!(counts.delivered, of(&expected.delivered, k + 1), "{}", why());
        by_taps += counts.rejected;
    }
    assert_eq!(by_taps, expected.rejected.len() as u64, "{}", why());
}

/// Asks the pure function at the end of every tick, from the newest stamps alone.
pub(crate) fn holder_agrees(suppressors: &[Suppressor], history: &[u32]) {
    let mut series = (1..=suppressors.len()).collect::<Vec<_>>();
    series.sort_by_key(|&tap| suppressors[tap - 1].level);
    let mut expected = Input::new(suppressors);
    let mut newest = vec![None; suppressors.len() + 1];
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        expected.tick(now, |s| wrote(row, s));
        for (source, stamp) in newest.iter_mut().enumerate() {
            if wrote(row, source) {
                *stamp = Some(Time(now));
            }
        }
        let windows = series.iter().map(|&tap| {
            newest[tap].map(|stamp| Window {
                stamp,
                time_constant: Span(suppressors[tap - 1].tau),
            })
        });
        let held = holder(newest[0], windows).map(|k| {
            let source = if k == 0 { 0 } else { series[k - 1] };
            (newest[source].unwrap().0, source)
        });
        assert_eq!(held, expected.held(), "{suppressors:?} {history:?} tick {now}");
    }
}

#[test]
fn a_window_is_closed_at_its_start_and_open_at_its_end() {
    let (t, tau) = (Time(1_000), Span(50));
    let window = [Window {
        stamp: t,
        time_constant: tau,
    }];
    for (u, rejected) in [(999, false), (1_000, true), (1_049, true), (1_050, false)] {
        let u = Time(u);
        assert_eq!(window[0].holds(u), rejected, "{u:?}");
        assert_eq!(passes(u, window), !rejected, "{u:?}");
        assert_eq!(emits(u, window), !rejected, "{u:?}");
        let left = if rejected { 1_050 - u.0 } else { 0 };
        assert_eq!(window[0].remaining(u), Span(left), "{u:?}");
        let held = holder(Some(u), window.map(Some));
        assert_eq!(held, Some(usize::from(u < t + tau)), "{u:?}");
    }
}

#[test]
fn windows_at_the_ends_of_time_do_not_wrap() {
    let ever = Window {
        stamp: Time(u64::MAX - 1),
        time_constant: Span(10),
    };
    assert!(ever.holds(Time(u64::MAX)));
    assert!(!ever.holds(Time(0)));
    let zero = Window {
        stamp: Time(0),
        time_constant: Span(u64::MAX),
    };
    assert!(zero.holds(Time(0)) && zero.holds(Time(u64::MAX - 1)) && !zero.holds(Time(u64::MAX)));
}

#[test]
fn a_register_agrees_at_the_very_edges_of_a_window() {
    let tap = [Suppressor { level: 1, tau: 50 }];
    for u in [0, 9, 10, 11, 58, 59, 60, 61] {
        for again in [None, Some(30), Some(59), Some(60)] {
            let mut history = vec![0; 120];
            history[10] |= 2;
            if let Some(again) = again {
                history[again] |= 2;
            }
            history[u] |= 1;
            holder_agrees(&tap, &history);
            for look in LOOKS {
                register_agrees(&tap, &history, look);
            }
        }
    }
}

#[test]
fn one_suppressor_every_history() {
    for history in histories(2, 6) {
        for tau in 1..=6 {
            let tap = [Suppressor { level: 1, tau }];
            holder_agrees(&tap, &history);
            LOOKS
                .iter()
                .for_each(|&look| register_agrees(&tap, &history, look));
        }
    }
}

#[test]
fn two_suppressors_every_history() {
    for history in histories(3, 4) {
        for taus in choices(2, &[1, 2, 3]) {
            for levels in [[1, 1], [1, 2], [2, 1]] {
                let taps = suppressors(&levels, &taus);
                holder_agrees(&taps, &history);
                LOOKS
                    .iter()
                    .for_each(|&look| register_agrees(&taps, &history, look));
            }
        }
    }
}

#[test]
fn three_suppressors_every_history_in_stamps() {
    for history in histories(4, 4) {
        for taus in choices(3, &[1, 3]) {
            holder_agrees(&suppressors(&[1, 2, 3], &taus), &history);
        }
        holder_agrees(&suppressors(&[2, 2, 1], &[2, 3, 4]), &history);
    }
}

#[test]
fn three_suppressors_every_history_in_registers() {
    for history in histories(4, 3) {
        for taus in choices(3, &[1, 2]) {
            for levels in choices(3, &[1, 2, 3]) {
                let taps = suppressors(&levels, &taus);
                register_agrees(&taps, &history, Look::Every(1));
                register_agrees(&taps, &history, Look::Every(3));
            }
        }
    }
    for history in histories(4, 4) {
        for look in LOOKS {
            register_agrees(&suppressors(&[1, 2, 3], &[3, 2, 1]), &history, look);
            register_agrees(&suppressors(&[2, 2, 1], &[1, 2, 3]), &history, look);
        }
    }
}
