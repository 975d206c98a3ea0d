//! How long one evaluation of a hierarchy of 1,000 RMs takes, from the top.
//!
//! `cargo run --release -p adroit --example evaluate`
//!
//! Two cases: the first choice at each level succeeds; every RM of the hierarchy is asked, for all but the
//! fall-back fail, each level scanned once for each of its RMs.

use std::hint::black_box;
use std::time::Instant;

use adroit::hierarchy::{CriterionId, Goal, Senses, StateId, StimulusId};
use adroit::language::{Vocabulary, load};

/// Ten at the top, nine below each, ten below each of those, and the fall-back: 1,001.
const TOP: usize = 10;
const MIDDLE: usize = 9;
const LEAVES: usize = 10;

struct Stage {
    found: bool,
}

impl Senses for Stage {
    fn stimulus(&self, stimulus: StimulusId, _: &Goal) -> f64 {
        f64::from(stimulus.0) * 0.5
    }

    fn select(&self, _: CriterionId, given: &Goal) -> Option<Goal> {
        self.found.then_some(*given)
    }

    fn holds(&self, _: StateId, _: &Goal) -> bool {
        false
    }
}

fn program() -> String {
    let mut text = String::from(
        "rm rest reports to top. add stimulus always to rm rest with magnitude 0.1. mcu m reports to rm rest.\n",
    );
    let mut rm = |name: &str, above: &str, magnitude: usize, leaf: bool| {
        text += &format!(
            "rm {name} reports to {above}. add stimulus a to rm {name} with magnitude {magnitude}. add stimulus b to \
             rm {name} with magnitude 1. add stimulus c to rm {name} with magnitude -0.1.\n"
        );
        if leaf {
            text += &format!("rm {name} selects goal p. mcu m reports to rm {name}.\n");
        }
    };
    for top in 0..TOP {
        rm(&format!("t{top}"), "top", top + 1, false);
        for middle in 0..MIDDLE {
            rm(
                &format!("t{top}m{middle}"),
                &format!("rm t{top}"),
                middle + 1,
                false,
            );
            for leaf in 0..LEAVES {
                rm(
                    &format!("t{top}m{middle}l{leaf}"),
                    &format!("rm t{top}m{middle}"),
                    leaf + 1,
                    true,
                );
            }
        }
    }
    text
}

fn main() {
    let vocabulary = Vocabulary::new(&["a", "b", "c"], &["p"], &[], &["m"]);
    let mut hierarchy = load(&program(), &vocabulary).expect("the program is right");
    println!(
        "{} RMs at {} levels, three inputs each",
        hierarchy.mechanisms().len(),
        hierarchy.levels().len()
    );
    for (caption, found) in [
        ("first choices succeed", true),
        ("every RM is asked, all fail", false),
    ] {
        let stage = Stage { found };
        let mut times_ns: Vec<u128> = Vec::new();
        let mut asked = 0;
        for _ in 0..20_000 {
            let start = Instant::now();
            asked = black_box(hierarchy.evaluate(black_box(&stage))).asked;
            times_ns.push(start.elapsed().as_nanos());
        }
        times_ns.sort_unstable();
        let at = |share: f64| times_ns[((times_ns.len() - 1) as f64 * share) as usize] as f64 / 1000.0;
        println!(
            "{caption}: {asked} RMs asked, {:.2} us median, {:.2} us at 99.9 %, {:.2} us at most",
            at(0.5),
            at(0.999),
            at(1.0)
        );
    }
}
