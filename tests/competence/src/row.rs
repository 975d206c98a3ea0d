//! The rows of the competence table: which levels run, in what office, and what is done to them.
//!
//! Must never hold a wiring of its own: every creature is the shipped text with parameters changed and layers
//! added.

use std::fmt::Write as _;
use std::path::Path;

/// First layout seed of measurements: the offices that layers are built in are 1 to 10.
pub const LAYOUTS_FROM: u64 = 1000;

/// What is done to the upper levels while a trial runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Nothing.
    None,
    /// Level 2 is killed and started again at random, dead half of the time.
    Killed,
    /// Level 2 is killed a minute after the start and stays dead: what is left should do as it does alone.
    Cut,
    /// In the place of levels 1 and 2 run layers that write what is no message, a thousand times a second.
    Nonsense,
    /// In their place run layers that write random headings, a thousand times a second.
    Chatter,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// How `--rows` names it.
    pub name: &'static str,
    /// How the table names it.
    pub title: &'static str,
    /// How many of the levels 0, 1, 2 … run.
    pub levels: usize,
    /// What is done to them.
    pub disturbance: Disturbance,
    /// Whether all figures of sonar noise are doubled.
    pub noisy: bool,
    /// How many sonars are dead.
    pub dead: usize,
    /// Hours that a charge lasts; nought stands for ever.
    pub battery_h: f64,
    /// How many robots are in the office.
    pub robots: usize,
    /// Whether it is an empty, quiet room instead.
    pub quiet: bool,
    /// Which world.
    pub world: World,
}

/// A world that Allen can be put into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum World {
    /// The office.
    Office,
    /// The warehouse, a world of another making; it has no camera and no rooms.
    Warehouse,
}

const PLAIN: Row = Row {
    name: "",
    title: "",
    levels: 1,
    disturbance: Disturbance::None,
    noisy: false,
    dead: 0,
    battery_h: 0.0,
    robots: 1,
    quiet: false,
    world: World::Office,
};

/// Every row there is.
pub const ROWS: &[Row] = &[
    Row {
        name: "quiet",
        title: "level 0, empty quiet room",
        quiet: true,
        ..PLAIN
    },
    Row {
        name: "0",
        title: "level 0",
        ..PLAIN
    },
    Row {
        name: "01",
        title: "levels 0+1",
        levels: 2,
        ..PLAIN
    },
    Row {
        name: "012",
        title: "levels 0+1+2",
        levels: 3,
        ..PLAIN
    },
    Row {
        name: "killed",
        title: "0+1+2, level 2 killed and restarted",
        levels: 3,
        disturbance: Disturbance::Killed,
        ..PLAIN
    },
    Row {
        name: "cut",
        title: "0+1+2, level 2 killed for good",
        levels: 3,
        disturbance: Disturbance::Cut,
        ..PLAIN
    },
    Row {
        name: "nonsense",
        title: "level 0, 1 and 2 flooding nonsense",
        disturbance: Disturbance::Nonsense,
        ..PLAIN
    },
    Row {
        name: "chatter",
        title: "level 0, 1 and 2 flooding headings",
        disturbance: Disturbance::Chatter,
        ..PLAIN
    },
    Row {
        name: "noise",
        title: "0+1+2, sonar noise doubled",
        levels: 3,
        noisy: true,
        ..PLAIN
    },
    Row {
        name: "dead",
        title: "0+1+2, six of twelve sonars dead",
        levels: 3,
        dead: 6,
        ..PLAIN
    },
    Row {
        name: "two",
        title: "0+1+2, two robots in one office",
        levels: 3,
        robots: 2,
        ..PLAIN
    },
    Row {
        name: "six",
        title: "six levels, a battery for forty minutes",
        levels: 6,
        battery_h: 0.67,
        ..PLAIN
    },
    Row {
        name: "other0",
        title: "level 0 in another world",
        world: World::Warehouse,
        ..PLAIN
    },
    Row {
        name: "other01",
        title: "levels 0+1 in another world",
        levels: 2,
        world: World::Warehouse,
        ..PLAIN
    },
];

/// The row called `name`.
pub fn find(name: &str) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.name == name)
}

/// Manifests of the levels above 0, lowest first.
pub const MANIFESTS: &[&str] = &[
    allen::WANDER,
    allen::EXPLORE,
    allen::CORRIDOR,
    allen::COMPANY,
    allen::HOME,
];

impl Row {
    /// Whether it is measured in an office with rooms and people.
    pub fn is_in_an_office(&self) -> bool {
        self.world == World::Office && !self.quiet
    }

    /// The creature file of this row with `seed`; `layout` is the body's line that says where.
    pub fn text(&self, seed: u64, layout: &str) -> String {
        let mut body = String::from(layout);
        if self.world == World::Warehouse {
            body = format!("kind = \"warehouse\"\nnumber = {seed}\npeople = 6");
        } else if self.quiet {
            body = "layout = \"empty\"\npeople = 0\nattackers = 0".into();
        } else {
            body += "\npeople = 5\nattackers = 1\ncornerers = 1\ntalkers = 3";
        }
        if self.noisy {
            body += "\nnoise = 0.04\ndropout = 0.02\nghosts = 0.6\ncross_talk = 0.02";
        }
        if self.dead > 0 {
            let _ = write!(body, "\ndead = {:?}", dead(self.dead, seed));
        }
        if self.battery_h > 0.0 {
            let _ = write!(body, "\ncharge = {:?}", self.battery_h);
        }
        let mut text = String::new();
        for line in allen::CREATURE.lines() {
            let key = line.split('=').next().unwrap_or("").trim();
            match key {
                "seed" => {
                    let _ = writeln!(text, "seed = {seed}");
                }
                "people" | "attackers" => {}
                "collide" if self.world == World::Warehouse => text.push_str(SLOW_BRAKES),
                "kind" if line.contains("\"office\"") => {
                    let kind = if self.world == World::Office { line } else { "" };
                    let _ = writeln!(text, "{kind}\n{body}");
                }
                _ => {
                    let _ = writeln!(text, "{line}");
                }
            }
        }
        for manifest in &MANIFESTS[..self.levels.saturating_sub(1).min(MANIFESTS.len())] {
            let layer = manifest.find("[[layer]]").expect("a manifest has a layer");
            let _ = write!(text, "\n{}", &manifest[layer..]);
        }
        let flood = match self.disturbance {
            Disturbance::Nonsense => "nonsense",
            Disturbance::Chatter => "chatter",
            _ => return text,
        };
        let _ = write!(text, "{}", FLOOD.replace("KIND", flood));
        text
    }

    /// [`Row::text`] in the office of the file `layout`, if there is one, else in that of [`Row::measured`].
    pub fn asked(&self, seed: u64, layout: Option<&Path>) -> String {
        match layout {
            Some(path) => self.text(seed, &format!("layout_file = {:?}", path.display().to_string())),
            None => self.measured(seed),
        }
    }

    /// [`Row::text`] in the office that belongs to `seed` in measurements.
    pub fn measured(&self, seed: u64) -> String {
        let number = LAYOUTS_FROM + seed;
        self.text(seed, &format!("layout = \"generated\"\nnumber = {number}"))
    }
}

/// The warehouse's wheels follow a command with a time constant of 0.15 s: from full speed to 1 cm/s takes them 0.51 s,
/// where brakes of 1 m/s2 take 0.29 s. Whoever puts the layers on such a base says so.
const SLOW_BRAKES: &str = "collide = { kind = \"allen.collide\", latency = \"280ms\" }\n";

/// What floods in the place of levels 1 and 2: one layer for each, both into what level 0 opens.
const FLOOD: &str = r#"
[[layer]]
name = "flood-1"
level = 1
period = "1ms"
suppress = [{ from = "flood1.heading", input = "turn.heading", time_constant = "2s" }]
[layer.modules]
flood1 = { kind = "trial.KIND" }

[[layer]]
name = "flood-2"
level = 2
period = "1ms"
suppress = [{ from = "flood2.heading", input = "turn.heading", time_constant = "2s" }]
[layer.modules]
flood2 = { kind = "trial.KIND" }
"#;

/// So many different sonars out of twelve, drawn by the seed.
fn dead(count: usize, seed: u64) -> Vec<f64> {
    let mut random = afsm::random::Random::new(seed ^ 0xdead);
    let mut left: Vec<f64> = (0..office::SONARS).map(|i| i as f64).collect();
    (0..count)
        .map(|_| left.swap_remove(random.between(0.0, left.len() as f64) as usize))
        .collect()
}
