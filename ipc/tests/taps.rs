//! The side-tap rules, checked message by message against a model of their own.
//!
//! Must never share a line of reasoning with the sources: the model below keeps every message there ever
//! was and every window that was ever opened, and asks the rules of Brooks 1991 §6.2 of each in turn.
//!
//! A *history* says who wrote in which tick: bit `source` of `history[tick]`. Source 0 is the existing wire
//! (or the module that emits on it), the others are the taps in the order of declaration.

use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::message::{Kind, WORDS_MAX, Words};
use ipc::tap::{Window, emits, holder, passes};
use ipc::wire::{Limits, Outlet, Page, Register, TapEnd, Writer};
use proptest::prelude::*;

/// What the rules say, from all messages that ever were.
mod model {
    /// A message: in which tick, by which source.
    pub(crate) type Message = (u64, usize);

    /// A suppressor as it is declared.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Suppressor {
        pub(crate) level: u8,
        pub(crate) tau: u64,
    }

    /// Whether any of the messages at `ticks` rejects one at `u`: t ≤ u < t+τ.
    pub(crate) fn rejects(ticks: &[u64], tau: u64, u: u64) -> bool {
        ticks.iter().any(|&t| t <= u && u < t + tau)
    }

    /// An input with its suppressors, which are told of messages tick by tick.
    #[derive(Clone, Debug, Default)]
    pub(crate) struct Input {
        suppressors: Vec<Suppressor>,
        /// Every message that ever came, by source.
        came: Vec<Vec<u64>>,
        pub(crate) delivered: Vec<Message>,
        pub(crate) rejected: Vec<Message>,
    }

    impl Input {
        pub(crate) fn new(suppressors: &[Suppressor]) -> Input {
            Input {
                suppressors: suppressors.to_vec(),
                came: vec![Vec::new(); suppressors.len() + 1],
                ..Input::default()
            }
        }

        /// Whether tap `a` stands further along the wire than `source`: everything stands further along
        /// than the existing wire, and then level decides, and declaration within a level.
        fn further_along(&self, a: usize, source: usize) -> bool {
            if source == 0 {
                return true;
            }
            let (x, y) = (self.suppressors[a - 1].level, self.suppressors[source - 1].level);
            x > y || (x == y && a > source)
        }

        /// All messages of one tick.
        pub(crate) fn tick(&mut self, now: u64, wrote: impl Fn(usize) -> bool) {
            let sources = (0..self.came.len()).filter(|&s| wrote(s)).collect::<Vec<_>>();
            for &source in &sources {
                self.came[source].push(now);
            }
            for source in sources {
                let stopped = (1..self.came.len()).any(|tap| {
                    self.further_along(tap, source)
                        && rejects(&self.came[tap], self.suppressors[tap - 1].tau, now)
                });
                if stopped {
                    self.rejected.push((now, source));
                } else {
                    self.delivered.push((now, source));
                }
            }
        }

        /// The message in the register: the last that was delivered.
        pub(crate) fn held(&self) -> Option<Message> {
            self.delivered.last().copied()
        }
    }
}

use model::{Input, Suppressor};

const ANY: Limits = Limits {
    kind: Kind::Vector,
    low: -1e9,
    high: 1e9,
};

/// A message that says when and by whom it was written.
fn words(tick: u64, source: usize) -> Words {
    let mut words = [0.0; WORDS_MAX];
    words[0] = tick as f64;
    words[1] = source as f64;
    words
}

fn said(held: Option<&(Time, Words)>) -> Option<(u64, usize)> {
    held.map(|(stamp, words)| {
        assert_eq!(stamp.0, words[0] as u64, "a message keeps its own stamp");
        (stamp.0, words[1] as usize)
    })
}

fn end(page: &Arc<Page>, wire: usize, tau: u64, level: u8, plug: u32) -> TapEnd {
    TapEnd {
        reader: page.reader(wire, Kind::Vector).unwrap(),
        time_constant: Span(tau),
        level,
        plug,
        id: wire as u32,
        gauge: Arc::default(),
    }
}

fn writers(page: &Arc<Page>) -> Vec<Writer> {
    (0..page.len())
        .map(|wire| page.writer(wire, Kind::Vector).unwrap())
        .collect()
}

/// An input with its wire and taps on a page in memory.
struct Real {
    writers: Vec<Writer>,
    register: Register,
}

impl Real {
    fn new(suppressors: &[Suppressor]) -> Real {
        let page = Page::in_memory(suppressors.len() + 1);
        let mut register = Register::new(ANY, page.reader(0, Kind::Vector));
        for (k, s) in suppressors.iter().enumerate() {
            register.suppress(end(&page, k + 1, s.tau, s.level, 0)).unwrap();
        }
        Real {
            writers: writers(&page),
            register,
        }
    }

    fn write(&mut self, now: u64, source: usize) {
        self.writers[source].write(Time(now), &words(now, source));
    }

    fn gather(&mut self, now: u64) {
        self.register
            .gather(Time(now), |_| panic!("nobody told a tap to go"));
    }
}

/// How often and in which order a register is looked at.
#[derive(Clone, Copy, Debug)]
enum Look {
    /// After each message, the existing wire's first or last within a tick.
    EachMessage { taps_first: bool },
    /// At the end of every n-th tick.
    Every(u64),
}

const LOOKS: [Look; 5] = [
    Look::EachMessage { taps_first: false },
    Look::EachMessage { taps_first: true },
    Look::Every(1),
    Look::Every(2),
    Look::Every(3),
];

fn wrote(row: u32, source: usize) -> bool {
    row >> source & 1 == 1
}

/// Steps a register through a history beside the model.
fn register_agrees(suppressors: &[Suppressor], history: &[u32], look: Look) {
    let mut expected = Input::new(suppressors);
    let mut real = Real::new(suppressors);
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
            let held = said(real.register.held());
            assert_eq!(
                held,
                expected.held(),
                "{suppressors:?} {history:?} {look:?} tick {now}"
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
        counts_agree(&real.register, &expected, suppressors, history);
    }
}

/// Looked at every tick, a register misses nothing, and counts what the model counts.
fn counts_agree(register: &Register, expected: &Input, suppressors: &[Suppressor], history: &[u32]) {
    let of = |messages: &[(u64, usize)], source| messages.iter().filter(|m| m.1 == source).count() as u64;
    let counts = register.counts();
    let why = || format!("{suppressors:?} {history:?}");
    assert_eq!(counts.faults, 0, "{}", why());
    assert_eq!(counts.delivered, expected.delivered.len() as u64, "{}", why());
    assert_eq!(counts.rejected, of(&expected.rejected, 0), "{}", why());
    let mut by_taps = 0;
    for tap in register.taps() {
        let source = tap.id as usize;
        assert_eq!(tap.counts.delivered, of(&expected.delivered, source), "{}", why());
        by_taps += tap.counts.rejected;
    }
    assert_eq!(by_taps, expected.rejected.len() as u64, "{}", why());
}

/// Asks the pure function at the end of every tick, from the newest stamps alone.
fn holder_agrees(suppressors: &[Suppressor], history: &[u32]) {
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

/// Every history of `sources` sources over `ticks` ticks.
fn histories(sources: usize, ticks: usize) -> impl Iterator<Item = Vec<u32>> {
    let row = (1_u32 << sources) - 1;
    (0..1_u64 << (sources * ticks)).map(move |bits| {
        (0..ticks)
            .map(|tick| (bits >> (tick * sources)) as u32 & row)
            .collect()
    })
}

/// Every choice of `n` numbers from `from`.
fn choices(n: usize, from: &[u64]) -> Vec<Vec<u64>> {
    (0..n).fold(vec![vec![]], |all, _| {
        all.iter()
            .flat_map(|some| from.iter().map(|&x| [&some[..], &[x]].concat()))
            .collect()
    })
}

fn suppressors(levels: &[u64], taus: &[u64]) -> Vec<Suppressor> {
    let pairs = levels.iter().zip(taus);
    pairs
        .map(|(&level, &tau)| Suppressor {
            level: level as u8,
            tau,
        })
        .collect()
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

fn inhibit_and_suppress(history: &[u32], inhibit: u64, suppress: u64, stride: u64) {
    let page = Page::in_memory(3);
    let mut register = Register::new(ANY, page.reader(0, Kind::Vector));
    register.suppress(end(&page, 2, suppress, 1, 0)).unwrap();
    let mut outlet = Outlet::new(page.writer(0, Kind::Vector).unwrap());
    outlet.inhibit(end(&page, 1, inhibit, 1, 0)).unwrap();
    let mut inhibitor = page.writer(1, Kind::Vector).unwrap();
    let mut suppressor = page.writer(2, Kind::Vector).unwrap();
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
        let why = format!("{history:?} inhibit {inhibit} suppress {suppress} tick {now}");
        assert_eq!(outlet.commit(Time(now), |_| panic!("{why}")), emits, "{why}");
        input.tick(now, |s| if s == 0 { emits } else { wrote(row, 2) });
        if now % stride == stride - 1 {
            register.gather(Time(now), |_| panic!("{why}"));
            assert_eq!(said(register.held()), input.held(), "{why}");
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

fn tap_on_tap(history: &[u32], suppress: u64, inhibit: u64, suppress_tap: u64) {
    const EXISTING: usize = 0;
    const MODULE: usize = 1;
    const TAP: usize = 4; // what a relay makes of the module's wire
    let page = Page::in_memory(5);
    let mut existing = page.writer(EXISTING, Kind::Vector).unwrap();
    let mut outlet = Outlet::new(page.writer(MODULE, Kind::Vector).unwrap());
    let mut inhibitor = page.writer(2, Kind::Vector).unwrap();
    let mut over_tap = page.writer(3, Kind::Vector).unwrap();
    let mut relayed = Outlet::new(page.writer(TAP, Kind::Vector).unwrap());
    outlet.inhibit(end(&page, 2, inhibit, 2, 0)).unwrap();
    let mut relay = Register::new(ANY, page.reader(MODULE, Kind::Vector));
    relay.suppress(end(&page, 3, suppress_tap, 2, 0)).unwrap();
    let mut register = Register::new(ANY, page.reader(EXISTING, Kind::Vector));
    register.suppress(end(&page, TAP, suppress, 1, 0)).unwrap();

    let mut inhibiting = Vec::new();
    let mut line = Input::new(&suppressors(&[2], &[suppress_tap]));
    let mut input = Input::new(&suppressors(&[1], &[suppress]));
    for (now, &row) in history.iter().enumerate() {
        let now = now as u64;
        let why = format!("{history:?} {suppress} {inhibit} {suppress_tap} tick {now}");
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
        assert_eq!(said(register.held()), input.held(), "{why}");
    }
}

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
            assert_eq!(end.id as usize, released);
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
        let wrote = outlet.commit(Time(now), |end| left.push((now, end.id)));
        assert_eq!(wrote, now >= 110, "{now}");
        outlet.release(7);
        inhibitor.write(Time(now), &words(now, 1));
    }
    assert_eq!(left, [(110, 1)]);
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

fn seen_late(history: &[u32], taps: &[Suppressor], late: &[u64]) {
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

/// A longer history with few messages in it, and the taps it runs past.
fn long() -> impl Strategy<Value = (Vec<Suppressor>, Vec<u32>)> {
    let tap = (0_u8..4, 1_u64..40).prop_map(|(level, tau)| Suppressor { level, tau });
    proptest::collection::vec(tap, 1..=5).prop_flat_map(|taps| {
        let sources = taps.len() + 1;
        let row = prop_oneof![3 => Just(0), 1 => 0_u32..1 << sources];
        (Just(taps), proptest::collection::vec(row, 1..200))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn long_histories_agree((taps, history) in long()) {
        holder_agrees(&taps, &history);
        LOOKS.iter().for_each(|&look| register_agrees(&taps, &history, look));
    }

    #[test]
    fn long_histories_agree_when_seen_late((taps, history) in long(), late in proptest::collection::vec(0_u64..5, 6)) {
        seen_late(&history, &taps, &late);
    }

    #[test]
    fn long_inhibitions_agree((taps, history) in long(), tau in 1_u64..40, stride in 1_u64..5) {
        inhibit_and_suppress(&history, tau, taps[0].tau, stride);
        tap_on_tap(&history, tau, taps[0].tau, 1 + stride);
    }
}
