//! What the rules of Brooks 1991 §6.2 say, asked of every message of a whole creature in turn.
//!
//! Must never forget a message or merge two windows: it keeps all there ever was, and is as slow as that.

use std::collections::{BTreeMap, BTreeSet};

use crate::drawn::{Case, END, LEVELS};

/// A message: when, what.
pub(crate) type Message = (u64, f64);

/// What came of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Account {
    /// Messages on each module's wire.
    pub(crate) written: Vec<Vec<Message>>,
    /// Messages delivered to each module's input.
    pub(crate) delivered: Vec<Vec<Message>>,
    /// Delivered and rejected at each tap.
    pub(crate) taps: Vec<(u64, u64)>,
}

struct Model<'c> {
    case: &'c Case,
    written: Vec<Vec<Message>>,
    /// Messages that inhibitors dropped: when, from which module.
    dropped: Vec<(u64, usize)>,
}

/// What must come of `case`.
pub(crate) fn expected(case: &Case) -> Account {
    let mut model = Model {
        case,
        written: vec![Vec::new(); case.modules.len()],
        dropped: Vec::new(),
    };
    let mut puts: BTreeMap<u64, Vec<(usize, f64)>> = BTreeMap::new();
    for put in &case.puts {
        puts.entry(put.at).or_default().push((put.module, put.value));
    }
    let mut moments: BTreeSet<u64> = puts.keys().copied().collect();
    for (period, phase) in case.beats {
        moments.extend((0..).map(|n| phase + n * period).take_while(|t| *t < END));
    }
    for now in moments {
        let mut said: Vec<(usize, f64)> = puts.remove(&now).unwrap_or_default();
        said.extend(model.steps(now));
        // The highest level writes first: what it says now counts for those below.
        for level in (0..LEVELS).rev() {
            for (module, value) in &said {
                if case.modules[*module].level == level {
                    model.write(now, *module, *value);
                }
            }
        }
    }
    model.account()
}

impl Model<'_> {
    /// What the modules say that step now, from messages written before now.
    fn steps(&self, now: u64) -> Vec<(usize, f64)> {
        let mut said = Vec::new();
        for (module, drawn) in self.case.modules.iter().enumerate() {
            let (period, phase) = self.case.beats[drawn.level];
            if drawn.source.is_none() || now < phase || !(now - phase).is_multiple_of(period) {
                continue;
            }
            let since = if now >= phase + period { now - period } else { 0 };
            let heard = self.deliveries(module);
            let newest = heard.iter().rfind(|(at, _)| since <= *at && *at < now);
            said.extend(newest.map(|(_, value)| (module, *value)));
        }
        said
    }

    fn write(&mut self, now: u64, module: usize, value: f64) {
        if self.inhibitors(module).any(|tap| self.open(tap, now)) {
            self.dropped.push((now, module));
        } else {
            self.written[module].push((now, value));
        }
    }

    fn inhibitors(&self, module: usize) -> impl Iterator<Item = usize> {
        let taps = self.case.taps.iter().enumerate();
        taps.filter(move |(_, t)| t.inhibits && t.to == module)
            .map(|(tap, _)| tap)
    }

    /// The suppressors before a module's input as they stand in series.
    fn series(&self, module: usize) -> Vec<usize> {
        let taps = self.case.taps.iter().enumerate();
        let mut series: Vec<usize> = taps
            .filter(|(_, t)| !t.inhibits && t.to == module)
            .map(|(tap, _)| tap)
            .collect();
        series.sort_by_key(|&tap| (self.level(tap), tap));
        series
    }

    fn level(&self, tap: usize) -> usize {
        self.case.modules[self.case.taps[tap].from].level
    }

    /// Whether any message of the tap rejects one written at `u`: t ≤ u < t+τ.
    fn open(&self, tap: usize, u: u64) -> bool {
        let tap = &self.case.taps[tap];
        let messages = &self.written[tap.from];
        messages.iter().any(|(t, _)| *t <= u && u < t + tap.tau)
    }

    /// Everything that came towards a module's input: when, what, and after how many of its suppressors it
    /// joined the wire.
    fn towards(&self, module: usize) -> Vec<(u64, f64, usize)> {
        let Some(source) = self.case.modules[module].source else {
            return Vec::new();
        };
        let wires = std::iter::once(source);
        let taps = self
            .series(module)
            .into_iter()
            .map(|tap| self.case.taps[tap].from);
        let mut all = Vec::new();
        for (place, wire) in wires.chain(taps).enumerate() {
            all.extend(self.written[wire].iter().map(|(at, value)| (*at, *value, place)));
        }
        all.sort_by_key(|(at, _, place)| (*at, *place));
        all
    }

    fn deliveries(&self, module: usize) -> Vec<Message> {
        let series = self.series(module);
        let all = self.towards(module).into_iter();
        let passing = all.filter(|(at, _, place)| !series[*place..].iter().any(|&tap| self.open(tap, *at)));
        passing.map(|(at, value, _)| (at, value)).collect()
    }

    fn account(self) -> Account {
        let mut taps = vec![(0, 0); self.case.taps.len()];
        for module in 0..self.case.modules.len() {
            let series = self.series(module);
            for (at, _, place) in self.towards(module) {
                match series[place..].iter().rfind(|&&tap| self.open(tap, at)) {
                    Some(&tap) => taps[tap].1 += 1,
                    None if place > 0 => taps[series[place - 1]].0 += 1,
                    None => {}
                }
            }
        }
        for (tap, drawn) in self.case.taps.iter().enumerate() {
            if drawn.inhibits {
                taps[tap].0 = self.written[drawn.from].len() as u64;
            }
        }
        for (at, module) in &self.dropped {
            let mut open: Vec<usize> = self
                .inhibitors(*module)
                .filter(|&tap| self.open(tap, *at))
                .collect();
            open.sort_by_key(|&tap| (self.level(tap), tap));
            let last = open.last().expect("something dropped it");
            taps[*last].1 += 1;
        }
        Account {
            delivered: (0..self.case.modules.len()).map(|m| self.deliveries(m)).collect(),
            written: self.written,
            taps,
        }
    }
}
