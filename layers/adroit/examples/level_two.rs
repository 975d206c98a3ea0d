//! An ADROIT hierarchy as level 2, on a level 0 that avoids and a level 1 that wanders.
//!
//! `cargo run -p adroit --example level_two`
//!
//! ```text
//!  level 2  hierarchy ── heading ──┐
//!  level 1  wander ── heading ────(S)──┐        (S): the newest message of the higher level, while it lasts
//!  level 0  avoid ── force ────────────┴──► drive
//! ```
//!
//! Levels 0 and 1 are reduced to a line each; what matters is that the hierarchy only writes a message, that
//! level 0 goes on without being asked, and that silence of level 2 gives the robot back to level 1.

use adroit::hierarchy::{CriterionId, Goal, Hierarchy, Senses, StateId, StimulusId};
use adroit::language::{Vocabulary, load};

/// A suppressing message counts for this many beats.
const TIME_CONSTANT_BEATS: u32 = 5;

const PROGRAM: &str = "
rm go-to-light reports to top.
  add stimulus light to rm go-to-light with magnitude 1.
  threshold of rm go-to-light is 0.2.
  rm go-to-light selects goal light-in-view.
  goal state of rm go-to-light is at-light.
  mcu heading reports to rm go-to-light.
rm let-be reports to top.
  add stimulus always to rm let-be with magnitude 0.1.
  mcu silence reports to rm let-be.
";

/// Sensor wires as level 2 reads them.
struct Wires {
    place: f64,
    light_at: f64,
    light_on: bool,
}

impl Senses for Wires {
    fn stimulus(&self, _: StimulusId, _: &Goal) -> f64 {
        if self.light_on {
            1.0 / (1.0 + (self.light_at - self.place).abs() / 10.0)
        } else {
            0.0
        }
    }

    fn select(&self, _: CriterionId, _: &Goal) -> Option<Goal> {
        self.light_on.then(|| Goal::at(self.light_at, 0.0))
    }

    fn holds(&self, _: StateId, goal: &Goal) -> bool {
        (goal.x_m - self.place).abs() < 0.2
    }
}

/// Level 2: what it writes, if anything.
fn level_two(hierarchy: &mut Hierarchy, wires: &Wires, vocabulary: &Vocabulary) -> Option<f64> {
    hierarchy.evaluate(wires);
    let output = hierarchy.outputs().first()?;
    (vocabulary.mcu_name(output.mcu) == "heading").then(|| (output.goal.x_m - wires.place).signum())
}

/// Level 1: to and fro.
fn wander(beat: u32) -> f64 {
    if (beat / 10).is_multiple_of(2) { 0.3 } else { -0.3 }
}

/// Level 0: pushed back by a wall at 6, whoever wants to go there.
fn avoid(place: f64, heading: f64) -> f64 {
    if place > 5.5 { heading.min(0.0) } else { heading }
}

fn main() {
    let vocabulary = Vocabulary::new(
        &["light"],
        &["light-in-view"],
        &["at-light"],
        &["heading", "silence"],
    );
    let mut hierarchy = load(PROGRAM, &vocabulary).expect("the program is right");
    let mut wires = Wires {
        place: 0.0,
        light_at: 4.0,
        light_on: false,
    };
    let mut newest: Option<(u32, f64)> = None;
    for beat in 0..90 {
        wires.light_on = (20..75).contains(&beat);
        if beat == 50 {
            wires.light_at = 9.0;
        }
        if let Some(heading) = level_two(&mut hierarchy, &wires, &vocabulary) {
            newest = Some((beat, heading));
        }
        let suppressed = newest.filter(|&(stamp, _)| beat < stamp + TIME_CONSTANT_BEATS);
        let heading = suppressed.map_or_else(|| wander(beat), |(_, heading)| heading);
        wires.place += 0.2 * avoid(wires.place, heading);
        if beat % 10 == 9 {
            let level = if suppressed.is_some() {
                "level 2"
            } else {
                "level 1"
            };
            println!("beat {beat:2}: at {:5.2}, heading of {level}", wires.place);
        }
    }
    assert!(wires.place < 5.8, "level 0 held the wall");
}
