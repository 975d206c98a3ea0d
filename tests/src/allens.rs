//! Allen's creature file in the variants that are tried: other bodies, with and without level 1.
//!
//! Must never hold a wiring of its own: every variant is the shipped text with a line changed or a layer added.

use std::fmt::Write as _;

/// A variant of Allen.
#[derive(Clone, Copy, Debug)]
pub struct Allen {
    /// Seed of everything random.
    pub seed: u64,
    /// People who walk about.
    pub people: u32,
    /// People who walk at the robot.
    pub attackers: u32,
    /// Whether the world is one empty room, not the office.
    pub empty: bool,
    /// Whether level 1, wander, is linked in.
    pub wander: bool,
}

impl Allen {
    /// Level 0 in the office that the creature file describes.
    pub const LEVEL_0: Allen = Allen {
        seed: 1,
        people: 6,
        attackers: 2,
        empty: false,
        wander: false,
    };

    /// Levels 0 and 1 in the same office.
    pub const LEVEL_1: Allen = Allen {
        wander: true,
        ..Allen::LEVEL_0
    };

    /// Level 0 alone in an empty room.
    pub const ALONE: Allen = Allen {
        people: 0,
        attackers: 0,
        empty: true,
        ..Allen::LEVEL_0
    };

    /// The same with another seed.
    pub fn seeded(self, seed: u64) -> Allen {
        Allen { seed, ..self }
    }

    /// The creature file of this variant.
    pub fn text(self) -> String {
        let shipped = allen::CREATURE;
        let mut text = changed(shipped, "seed = 1", &format!("seed = {}", self.seed));
        text = changed(&text, "people = 6", &format!("people = {}", self.people));
        text = changed(&text, "attackers = 2", &format!("attackers = {}", self.attackers));
        if self.empty {
            text = changed(
                &text,
                "kind = \"office\"",
                "kind = \"office\"\nlayout = \"empty\"",
            );
        }
        if self.wander {
            let layer = allen::WANDER.find("[[layer]]").expect("the manifest has a layer");
            let _ = write!(text, "\n{}", &allen::WANDER[layer..]);
        }
        text
    }
}

fn changed(text: &str, from: &str, to: &str) -> String {
    assert_eq!(
        text.matches(from).count(),
        1,
        "{from:?} stands once in allen.toml"
    );
    text.replacen(from, to, 1)
}
