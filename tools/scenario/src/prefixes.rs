//! Every prefix of the stack works: the scenarios of the levels up to k, with only those layers, and again while
//! layers above come and go.
//!
//! Must never ask of a creature what its higher levels are there to change: with layers above acting, only
//! *competences* are tried, scenarios that say `competence = true`: what they expect must hold whatever is
//! plugged, unplugged or killed above their own level.
//!
//! ```text
//!   for each k:   alone       layers up to k: every scenario of level k, and the competences of the levels below
//!                             with the layers between running all the time
//!                 meddled     every competence of level ≤ k, while all layers above k join, leave, stand still
//!                             and go on at moments drawn from a seed
//! ```
//! A scenario of a level below k that is no competence was tried at its own level, alone. To the layers below,
//! one that is killed and one that says good-bye are the same: nothing is written any more, windows run out.

use std::sync::Arc;

use afsm::Kinds;
use afsm::assemble::seed_of;
use afsm::random::Random;
use daemon::virtual_run::{Manifest, Stimulus};
use ipc::clock::Span;
use ipc::wiring::{Directory, Rejected};

use crate::plan::Scenario;
use crate::run::How;
use crate::suite::{Verdict, in_parallel, try_one};

/// A layer that can be plugged in.
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

impl Upper {
    /// The layer of `manifest`, checked against `host`: what the creature shows, and the layers made before it.
    ///
    /// # Errors
    /// Every error in it.
    pub fn new(manifest: Manifest, host: &mut Directory, kinds: &Kinds) -> Result<Upper, Rejected> {
        let checked = manifest.check(kinds, host)?;
        host.join_checked(&checked);
        let layer = checked.layers.first().expect("a checked manifest has a layer");
        Ok(Upper {
            name: layer.name.clone(),
            level: layer.level,
            manifest: Arc::new(manifest),
        })
    }
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
        let held = |s: &&Scenario| s.level == level || (s.level < level && s.competence);
        let mut alone: Vec<Scenario> = scenarios.iter().filter(held).cloned().collect();
        for scenario in &mut alone {
            scenario.creature.layers.retain(|l| l.level <= level);
            between(scenario, uppers, level);
        }
        let mut meddled = Vec::new();
        let (mut joins, mut leaves) = (0, 0);
        for scenario in scenarios.iter().filter(|s| s.competence && s.level <= level) {
            for seed in seeds {
                let mut with = scenario.clone();
                between(&mut with, uppers, level);
                let counts = meddle(&mut with, uppers, level, *seed);
                if counts.0 > 0 {
                    (joins, leaves) = (joins + counts.0, leaves + counts.1);
                    meddled.push(with);
                }
            }
        }
        for (way, tried, meddled) in [
            (Way::Alone, alone, (0, 0)),
            (Way::Meddled, meddled, (joins, leaves)),
        ] {
            prefixes.push(Prefix {
                level,
                way,
                verdicts: in_parallel(&tried, |s| try_one(s, kinds, How::default())),
                meddled,
            });
        }
    }
    prefixes
}

/// The layers that may join `scenario` beside those it plugs itself.
fn strangers<'u>(scenario: &Scenario, uppers: &'u [Upper]) -> Vec<&'u Upper> {
    let own = |upper: &&Upper| {
        let by_name = scenario.manifests.contains_key(&upper.name);
        let leaves = |(_, s): &(Span, Stimulus)| matches!(s, Stimulus::Leave(name) if *name == upper.name);
        by_name || scenario.stimuli.iter().any(leaves)
    };
    uppers.iter().filter(|u| !own(u)).collect()
}

/// The layers above the scenario's own level, up to `level`, run from the start; the lowest comes first, as others
/// may tap it.
fn between(scenario: &mut Scenario, uppers: &[Upper], level: u8) {
    let mut between = strangers(scenario, uppers);
    between.retain(|upper| upper.level > scenario.level && upper.level <= level);
    between.sort_by_key(|upper| upper.level);
    let mut plugs = Vec::new();
    for upper in between {
        invite(scenario, upper);
        plugs.push((Span::ZERO, Stimulus::Plug(upper.manifest.clone())));
    }
    scenario.stimuli.splice(0..0, plugs);
}

fn invite(scenario: &mut Scenario, upper: &Upper) {
    let (name, manifest) = (upper.name.clone(), upper.manifest.clone());
    scenario.manifests.insert(name, manifest);
}

/// What layers above do at the moments drawn for them.
fn meddle(scenario: &mut Scenario, uppers: &[Upper], level: u8, seed: u64) -> (usize, usize) {
    let (mut joins, mut leaves) = (0, 0);
    let mut events = Vec::new();
    for upper in strangers(scenario, uppers) {
        if upper.level <= level {
            continue;
        }
        let (mut here, mut still) = (false, false);
        invite(scenario, upper);
        // One that taps another of them is refused while that is away, and its going then is nothing.
        scenario.strangers.push(upper.name.clone());
        for (moment, choice) in moments(scenario, &upper.name, seed) {
            let name = upper.name.clone();
            let stimulus = match (here, still) {
                (false, _) => {
                    (here, still) = (true, false);
                    joins += 1;
                    Stimulus::Plug(upper.manifest.clone())
                }
                (true, false) if choice < 0.3 => {
                    still = true;
                    Stimulus::Freeze(name)
                }
                (true, true) if choice < 0.5 => {
                    still = false;
                    Stimulus::Thaw(name)
                }
                (true, _) => {
                    here = false;
                    leaves += 1;
                    Stimulus::Leave(name)
                }
            };
            events.push((moment, stimulus));
        }
    }
    // Layers of the creature file cannot leave: they stand still, from the start, and go on for a while.
    let own = scenario.creature.layers.iter().filter(|l| l.level > level);
    for name in own.map(|l| l.name.clone()) {
        events.push((Span::ZERO, Stimulus::Freeze(name.clone())));
        for (number, (moment, _)) in moments(scenario, &name, seed).into_iter().enumerate() {
            let goes_on = number.is_multiple_of(2);
            (joins, leaves) = (joins + usize::from(goes_on), leaves + usize::from(!goes_on));
            events.push(if goes_on {
                (moment, Stimulus::Thaw(name.clone()))
            } else {
                (moment, Stimulus::Freeze(name.clone()))
            });
        }
    }
    scenario.title = format!("{} (seed {seed})", scenario.title);
    scenario.stimuli.extend(events);
    scenario.stimuli.sort_by_key(|(at, _)| *at);
    (joins, leaves)
}

/// Moments at which something happens to the layer called `name`, each with a number from 0 to 1.
fn moments(scenario: &Scenario, name: &str, seed: u64) -> Vec<(Span, f64)> {
    let mut random = Random::new(seed_of(seed, &format!("{}/{name}", scenario.title)));
    let mut at = 0.0;
    let drawn = std::iter::repeat_with(|| {
        at += random.between(BETWEEN_S.0, BETWEEN_S.1);
        (
            Span::from_seconds(at).unwrap_or(Span(u64::MAX)),
            random.between(0.0, 1.0),
        )
    });
    drawn
        .take_while(|(moment, _)| *moment < scenario.duration)
        .collect()
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
