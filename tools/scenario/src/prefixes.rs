//! Every prefix of the stack works: the scenarios of the levels up to k, with only those layers, and again while
//! layers above come and go.
//!
//! Must never ask of a creature what its higher levels are there to change: with layers above acting, only
//! *competences* are tried, scenarios that say `competence = true`: what they expect must hold whatever is
//! plugged, unplugged or killed above their own level.
//!
//! ```text
//!   for each k:   alone       every scenario of level ≤ k, layers ≤ k only
//!                 meddled     every competence of level ≤ k, while the manifests above its level come and go at
//!                             moments drawn from a seed
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::seed_of;
use afsm::random::Random;
use daemon::virtual_run::{Manifest, Stimulus};
use ipc::clock::Span;

use crate::plan::Scenario;
use crate::run::How;
use crate::suite::{Verdict, in_parallel, try_one};

/// A layer that can be plugged in above.
#[derive(Clone, Debug)]
pub struct Upper {
    /// Its name.
    pub name: String,
    /// Its level.
    pub level: u8,
    /// How it is built.
    pub manifest: Arc<Manifest>,
}

/// How the scenarios are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// Only the layers up to the level.
    Alone,
    /// With layers above that come and go.
    Meddled,
}

impl Way {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Way::Alone => "alone",
            Way::Meddled => "meddled with",
        }
    }
}

/// What came of one level tried in one way.
#[derive(Clone, Debug)]
pub struct Prefix {
    /// The level k.
    pub level: u8,
    /// How.
    pub way: Way,
    /// What came of each scenario; each once for every seed.
    pub verdicts: Vec<Verdict>,
    /// How often a layer joined, left, over all runs.
    pub meddled: (usize, usize),
}

impl Prefix {
    /// Whether all passed.
    pub fn passed(&self) -> bool {
        self.verdicts.iter().all(Verdict::passed)
    }
}

/// Shortest and longest time between two comings and goings of one layer: shorter than the time constants
/// that creatures use and longer than a few of them.
const BETWEEN_S: (f64, f64) = (0.03, 3.0);

/// Tries every level from 0 to `top`: alone, and meddled with once for each of `seeds`.
pub fn prefixes(
    scenarios: &[Scenario],
    uppers: &[Upper],
    top: u8,
    seeds: &[u64],
    kinds: &Kinds,
) -> Vec<Prefix> {
    let mut prefixes = Vec::new();
    for level in 0..=top {
        let of_level: Vec<Scenario> = scenarios
            .iter()
            .filter(|s| s.level <= level)
            .map(|s| cut(s, level))
            .collect();
        let verdicts = in_parallel(&of_level, |s| try_one(s, kinds, How::default()));
        prefixes.push(Prefix {
            level,
            way: Way::Alone,
            verdicts,
            meddled: (0, 0),
        });
        let mut meddled = (0, 0);
        let mut with_uppers = Vec::new();
        for scenario in of_level.iter().filter(|s| s.competence) {
            for seed in seeds {
                let (meddling, joins, leaves) = meddle(scenario, uppers, level, *seed);
                meddled = (meddled.0 + joins, meddled.1 + leaves);
                with_uppers.extend((joins > 0).then_some(meddling));
            }
        }
        let verdicts = in_parallel(&with_uppers, |s| try_one(s, kinds, How::default()));
        prefixes.push(Prefix {
            level,
            way: Way::Meddled,
            verdicts,
            meddled,
        });
    }
    prefixes
}

/// The scenario with only the creature's layers up to `level`.
fn cut(scenario: &Scenario, level: u8) -> Scenario {
    let mut cut = scenario.clone();
    cut.creature.layers.retain(|l| l.level <= level);
    cut
}

/// The scenario with layers above `level` that come and go at moments drawn from `seed`; how often they came,
/// and went. Layers that the scenario itself plugs are left to it.
fn meddle(scenario: &Scenario, uppers: &[Upper], level: u8, seed: u64) -> (Scenario, usize, usize) {
    let mut meddled = scenario.clone();
    meddled.title = format!("{} (seed {seed})", scenario.title);
    let (mut joins, mut leaves) = (0, 0);
    for upper in uppers.iter().filter(|u| u.level > level) {
        let own = |(_, s): &(Span, Stimulus)| matches!(s, Stimulus::Leave(name) if *name == upper.name);
        if scenario.manifests.contains_key(&upper.name) || scenario.stimuli.iter().any(own) {
            continue;
        }
        meddled
            .manifests
            .insert(upper.name.clone(), upper.manifest.clone());
        let mut random = Random::new(seed_of(seed, &format!("{}/{}", scenario.title, upper.name)));
        let mut at = 0.0;
        let mut here = false;
        loop {
            at += random.between(BETWEEN_S.0, BETWEEN_S.1);
            let Some(moment) = Span::from_seconds(at).filter(|m| *m < scenario.duration) else {
                break;
            };
            let stimulus = if here {
                leaves += 1;
                // A layer that leaves and one that is killed are the same to those it leaves behind.
                Stimulus::Leave(upper.name.clone())
            } else {
                joins += 1;
                Stimulus::Plug(upper.manifest.clone())
            };
            here = !here;
            meddled.stimuli.push((moment, stimulus));
        }
    }
    meddled.stimuli.sort_by_key(|(at, _)| *at);
    (meddled, joins, leaves)
}

/// One line for each level and way, and what failed.
pub fn table(prefixes: &[Prefix]) -> String {
    use std::fmt::Write as _;
    let mut out = String::from("levels  way           scenarios  passed  joined  left\n");
    for p in prefixes {
        let passed = p.verdicts.iter().filter(|v| v.passed()).count();
        let levels = if p.level == 0 {
            "0".into()
        } else {
            format!("0-{}", p.level)
        };
        let _ = writeln!(
            out,
            "{levels:<6}  {:<12}  {:>9}  {passed:>6}  {:>6}  {:>4}{}",
            p.way.name(),
            p.verdicts.len(),
            p.meddled.0,
            p.meddled.1,
            if p.passed() { "" } else { "  FAILED" }
        );
    }
    for prefix in prefixes.iter().filter(|p| !p.passed()) {
        let failed = prefix.verdicts.iter().filter(|v| !v.passed()).cloned();
        let failed: Vec<Verdict> = failed.collect();
        let _ = write!(
            out,
            "\nlevels up to {}, {}:\n{}",
            prefix.level,
            prefix.way.name(),
            crate::report::text(&failed)
        );
    }
    out
}

/// As one JSON document.
pub fn json(prefixes: &[Prefix]) -> serde_json::Value {
    let one = |p: &Prefix| {
        let mut report = crate::report::json(&p.verdicts);
        report["level"] = p.level.into();
        report["way"] = p.way.name().into();
        report["joined"] = p.meddled.0.into();
        report["left"] = p.meddled.1.into();
        report
    };
    let all: Vec<_> = prefixes.iter().map(one).collect();
    serde_json::json!({ "passed": prefixes.iter().all(Prefix::passed), "prefixes": all })
}

/// The layers above by level, for those who want to know what there is.
pub fn levels(uppers: &[Upper]) -> BTreeMap<u8, Vec<&str>> {
    let mut levels: BTreeMap<u8, Vec<&str>> = BTreeMap::new();
    for upper in uppers {
        levels.entry(upper.level).or_default().push(&upper.name);
    }
    levels
}
