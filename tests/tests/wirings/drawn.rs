//! What is tried: wirings, taps and histories, drawn at random and so that they can be made smaller.
//!
//! Must never draw what a creature file may not say: taps point downward, wires never rely on a higher level.

use std::fmt::Write as _;

use proptest::prelude::*;

/// Most modules of a wiring.
pub(crate) const MODULES_MAX: usize = 20;
/// Levels there are.
pub(crate) const LEVELS: usize = 4;
/// When a run ends, ns.
pub(crate) const END: u64 = 500_000_000;
/// What times are multiples of, give or take a nanosecond.
const GRID: u64 = 5_000_000;

/// A module: silent if nothing feeds it, else one that says again what it hears.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    pub(crate) level: usize,
    pub(crate) source: Option<usize>,
}

/// A tap; `to` is the input of a module, or its output.
#[derive(Clone, Debug)]
pub(crate) struct Tap {
    pub(crate) inhibits: bool,
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) tau: u64,
}

/// A message put on a module's wire.
#[derive(Clone, Debug)]
pub(crate) struct Put {
    pub(crate) at: u64,
    pub(crate) module: usize,
    pub(crate) value: f64,
}

/// One wiring with one history.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) modules: Vec<Drawn>,
    pub(crate) taps: Vec<Tap>,
    pub(crate) puts: Vec<Put>,
    /// Period and phase of each level, ns.
    pub(crate) beats: [(u64, u64); LEVELS],
}

/// The port of the n-th module, input and output alike.
pub(crate) fn port(module: usize) -> String {
    format!("m{module}.value")
}

impl Case {
    /// The creature file.
    pub(crate) fn creature(&self) -> String {
        let mut text = String::from("creature = \"drawn\"\n");
        for level in 0..LEVELS {
            let here = || (0..self.modules.len()).filter(move |&m| self.modules[m].level == level);
            if here().next().is_none() {
                continue;
            }
            let (period, phase) = self.beats[level];
            let _ = writeln!(
                text,
                "[[layer]]\nname = \"l{level}\"\nlevel = {level}\nperiod = \"{period}ns\"\nphase = \"{phase}ns\""
            );
            let wires = here().filter_map(|m| Some((self.modules[m].source?, m)));
            let wires: Vec<String> = wires
                .map(|(from, to)| format!("\"{} -> {}\"", port(from), port(to)))
                .collect();
            let _ = writeln!(text, "wires = [{}]", wires.join(", "));
            for (key, end, inhibits) in [("suppress", "input", false), ("inhibit", "output", true)] {
                let taps = self.taps.iter();
                let taps = taps.filter(|t| t.inhibits == inhibits && self.modules[t.from].level == level);
                let taps: Vec<String> = taps
                    .map(|t| {
                        format!(
                            "{{ from = \"{}\", {end} = \"{}\", time_constant = \"{}ns\" }}",
                            port(t.from),
                            port(t.to),
                            t.tau
                        )
                    })
                    .collect();
                let _ = writeln!(text, "{key} = [{}]", taps.join(", "));
            }
            text.push_str("[layer.modules]\n");
            for m in here() {
                let kind = if self.modules[m].source.is_some() {
                    "relay"
                } else {
                    "mouth"
                };
                let _ = writeln!(text, "m{m} = {{ kind = \"trial.{kind}\" }}");
            }
        }
        text
    }
}

/// A time on the grid, or a nanosecond or half a step beside it.
fn time(steps: std::ops::Range<u64>) -> impl Strategy<Value = u64> {
    let beside = prop_oneof![4 => Just(0_i64), 1 => Just(-1), 1 => Just(1), 1 => Just(2_500_000)];
    (steps, beside).prop_map(|(step, off)| (step * GRID).saturating_add_signed(off))
}

/// Whether the wires into a module lead back to it.
fn feeds_itself(drawn: &[Drawn], module: usize) -> bool {
    let mut at = module;
    for _ in 0..drawn.len() {
        match drawn[at].source {
            Some(source) if source == module => return true,
            Some(source) => at = source,
            None => return false,
        }
    }
    false
}

type RawModule = (usize, bool, prop::sample::Index);
type RawTap = (bool, prop::sample::Index, prop::sample::Index, u64);

fn build(modules: Vec<RawModule>, taps: Vec<RawTap>, puts: Vec<(u64, prop::sample::Index)>) -> Case {
    let levels: Vec<usize> = modules.iter().map(|m| m.0).collect();
    let up_to = |level: usize| -> Vec<usize> { (0..levels.len()).filter(|&m| levels[m] <= level).collect() };
    let mut drawn: Vec<Drawn> = modules
        .iter()
        .map(|(level, silent, source)| Drawn {
            level: *level,
            source: (!silent).then(|| *source.get(&up_to(*level))),
        })
        .collect();
    // A loop of wires alone never says anything, and the checker knows; loops by way of taps remain.
    for module in 0..drawn.len() {
        if feeds_itself(&drawn, module) {
            drawn[module].source = None;
        }
    }
    let mut kept: Vec<Tap> = Vec::new();
    for (inhibits, from, to, tau) in taps {
        let from = from.index(drawn.len());
        let below: Vec<usize> = (0..drawn.len())
            .filter(|&m| levels[m] < levels[from] && (inhibits || drawn[m].source.is_some()))
            .collect();
        if below.is_empty() {
            continue;
        }
        let to = *to.get(&below);
        // One tap between two ports: their counts are told apart by their ends.
        if !kept.iter().any(|t| t.from == from && t.to == to) {
            kept.push(Tap {
                inhibits,
                from,
                to,
                tau,
            });
        }
    }
    let puts = puts
        .into_iter()
        .enumerate()
        .map(|(number, (at, module))| Put {
            at,
            module: module.index(drawn.len()),
            value: number as f64,
        })
        .collect();
    Case {
        modules: drawn,
        taps: kept,
        puts,
        beats: [(10_000_000, 0); LEVELS],
    }
}

/// Anything that may be tried.
pub(crate) fn case() -> impl Strategy<Value = Case> {
    let index = any::<prop::sample::Index>;
    let module = (0..LEVELS, prop::bool::weighted(0.4), index());
    let tap = (
        any::<bool>(),
        index(),
        index(),
        time(1..20).prop_map(|t| t.max(1)),
    );
    let put = (time(0..95), index());
    let beats = prop::array::uniform4((prop::sample::select(vec![5_u64, 10, 15, 20, 30]), 0_u64..4));
    let parts = (
        prop::collection::vec(module, 2..=MODULES_MAX),
        prop::collection::vec(tap, 0..=14),
        prop::collection::vec(put, 0..=80),
        beats,
    );
    parts.prop_map(|(modules, taps, puts, beats)| Case {
        beats: beats.map(|(period, phase)| {
            let period = period * 1_000_000;
            (period, (phase * 2_500_000) % period)
        }),
        ..build(modules, taps, puts)
    })
}
