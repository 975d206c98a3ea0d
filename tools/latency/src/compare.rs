//! Comparisons: the ratios that a run comes to, with the limits that hold for them.
//!
//! Must never compare what was not measured side by side, but a tap's effect with what it may take.

use crate::across::Means;
use crate::company::Company;
use crate::gate::{self, Compared, LIMITS};
use crate::pair::{Contest, Side};
use crate::ratio::Ratio;
use crate::run::{Asked, Outcome};

/// The part of a side that a comparison looks at.
type Part = fn(&Side) -> &hdrhistogram::Histogram<u64>;

/// Every comparison of the rounds, of quiet and churning intervals, and of a tap's effect.
pub fn compare(asked: &Asked, outcome: &Outcome) -> Vec<Compared> {
    let mut compared = rounds(outcome);
    compared.extend(churn(outcome));
    compared.extend(tap(asked, outcome));
    compared
}

/// Every comparison of the rounds so far.
pub fn rounds(outcome: &Outcome) -> Vec<Compared> {
    let mut compared = pairs(outcome);
    compared.extend(across(outcome));
    compared
}

fn pairs(outcome: &Outcome) -> Vec<Compared> {
    let wake_up: Part = |side| &side.wake_up;
    let error: Part = |side| &side.period_error;
    let response: Part = |side| &side.response;
    let rows: [(&str, Contest, Part, bool); 6] = [
        ("wake-up, ours / ours (control)", Contest::Control, wake_up, false),
        ("wake-up, sleep / cyclictest", Contest::Sleep, wake_up, true),
        (
            "wake-up and step, sleep / cyclictest's wake-up",
            Contest::Sleep,
            response,
            true,
        ),
        (
            "period error, ours / ours (control)",
            Contest::Control,
            error,
            false,
        ),
        ("period error, sleep / cyclictest", Contest::Sleep, error, false),
        ("period error, spin / cyclictest", Contest::Spin, error, true),
    ];
    let ratios = |contest: Contest, part: Part, q: f64| {
        let each = outcome.rounds_of(contest).map(|r| {
            let [ours, other] = &r.sides;
            part(ours).value_at_quantile(q) as f64 / part(other).value_at_quantile(q) as f64
        });
        Ratio::of(&each.collect::<Vec<f64>>())
    };
    let mut compared = Vec::new();
    for (what, contest, part, judged) in rows {
        for (q, quantile, base) in LIMITS {
            let Some(ratio) = ratios(contest, part, q) else {
                continue;
            };
            let control = ratios(Contest::Control, part, q);
            compared.push(Compared {
                what: what.into(),
                quantile,
                ratio,
                limit: judged.then(|| gate::limit(base, control.as_ref())),
            });
        }
    }
    compared
}

/// How long a tapping process's message took to its effect, against what it may take: a period of the tapped layer
/// and 100 µs at p50, two periods and 1 ms at p99.
fn tap(asked: &Asked, outcome: &Outcome) -> Vec<Compared> {
    let effect = outcome
        .tracks
        .iter()
        .find(|t| t.of == "tap" && t.metric == "effect");
    let Some(effect) = effect else {
        return Vec::new();
    };
    let period = asked.period.0;
    let bounds = [period + 100_000, 2 * period + 1_000_000];
    let rows = LIMITS.iter().zip(bounds);
    let row = |((q, quantile, base), bound): (&(f64, &'static str, f64), u64)| {
        let ratio = Ratio::of(&[effect.total.value_at_quantile(*q) as f64 / bound as f64])?;
        Some(Compared {
            what: "tap's effect / what it may take".into(),
            quantile,
            ratio,
            limit: Some(*base),
        })
    };
    rows.filter_map(row).collect()
}

/// How long a message takes to another process by a wire, against the other means.
fn across(outcome: &Outcome) -> Vec<Compared> {
    let mut compared = Vec::new();
    let others = [
        (Means::WireAgain, "a wire (control)", false),
        (Means::Blackboard, "a bare blackboard", true),
        (Means::Seqlock, "a bare sequence lock", false),
    ];
    for (other, name, judged) in others {
        for (q, quantile, base) in &LIMITS[..2] {
            let ratios = |means: Means| {
                let each = outcome.across.iter().map(|round| {
                    let at = |m: Means| round[m as usize].value_at_quantile(*q) as f64;
                    at(Means::Wire) / at(means)
                });
                Ratio::of(&each.collect::<Vec<f64>>())
            };
            let control = ratios(Means::WireAgain);
            compared.extend(ratios(other).map(|ratio| {
                Compared {
                    what: format!("message to another process, a wire / {name}"),
                    quantile,
                    ratio,
                    limit: (judged && outcome.across.len() >= ROUNDS_MIN)
                        .then(|| gate::limit(*base, control.as_ref())),
                }
            }));
        }
    }
    compared
}

/// Fewest rounds across processes that are judged: with fewer their spread says nothing.
const ROUNDS_MIN: usize = 3;

/// Step times of intervals in which layers came and went, against those just before without, and with the same
/// coming and going at a neighbour; over all layers.
fn churn(outcome: &Outcome) -> Vec<Compared> {
    let steps = || outcome.tracks.iter().filter(|t| t.metric == "step");
    let mut compared = Vec::new();
    for (before, what) in [
        (0, "step, with churn / without"),
        (1, "step, with churn / with the same at a neighbour"),
    ] {
        for (q, quantile, base) in &LIMITS[..2] {
            let mut ratios = Vec::new();
            for track in steps() {
                for (turn, company) in track.intervals.windows(3).zip(outcome.company.windows(3)) {
                    if company == Company::TURNS {
                        let value = |k: usize| turn[k].histogram.value_at_quantile(*q) as f64;
                        ratios.push(value(2) / value(before));
                    }
                }
            }
            compared.extend(Ratio::of(&ratios).map(|ratio| Compared {
                what: what.into(),
                quantile,
                ratio,
                limit: Some(*base),
            }));
        }
    }
    compared
}
