//! Allen: the first robot of Brooks 1991 §6.2 and figure 2, level by level.
//!
//! Level 0, [`level0`], keeps the robot from hitting things; level 1, [`level1`], makes it wander; level 2,
//! [`level2`], sets out for distant places. Three more are pasted on above: [`level3`] keeps to corridors,
//! [`level4`] follows people, [`level5`] goes home to charge. Each module is one file with its diagram. The
//! wiring stands in `allen.toml` and, for each further level as a process of its own, in a manifest of its own.
//!
//! Must never know the body: it meets it on wires.

pub mod geometry;
pub mod level0;
pub mod level1;
pub mod level2;
pub mod level3;
pub mod level4;
pub mod level5;

use afsm::{Kinds, ModuleKind};
use ipc::wiring::Source;

/// Allen with level 0 alone, open to taps of further levels.
pub const CREATURE: &str = include_str!("../allen.toml");

/// Allen with levels 0 and 1 in one daemon, open to taps of level 2.
pub const CREATURE_01: &str = include_str!("../allen-01.toml");

/// Allen with all three levels of the source in one daemon, open to taps of further levels.
pub const CREATURE_012: &str = include_str!("../allen-012.toml");

/// Level 1 as the manifest of a layer process.
pub const WANDER: &str = include_str!("../wander.toml");

/// Every kind of module that Allen is made of.
pub const MODULES: &[&ModuleKind] = &[
    &level0::sonar::KIND,
    &level0::collide::KIND,
    &level0::feelforce::KIND,
    &level0::runaway::KIND,
    &level0::turn::KIND,
    &level0::forward::KIND,
    &level1::wander::KIND,
    &level1::avoid::KIND,
    &level2::whenlook::KIND,
    &level2::stereo::KIND,
    &level2::pathplan::KIND,
    &level2::integrate::KIND,
    &level3::corridor::KIND,
    &level4::follow::KIND,
    &level5::hunger::KIND,
    &level5::trail::KIND,
];

/// Level 2 as the manifest of a layer process.
pub const EXPLORE: &str = include_str!("../explore.toml");

/// Level 3 as the manifest of a layer process.
pub const CORRIDOR: &str = include_str!("../corridor.toml");

/// Level 4 as the manifest of a layer process.
pub const COMPANY: &str = include_str!("../company.toml");

/// Level 5 as the manifest of a layer process.
pub const HOME: &str = include_str!("../home.toml");

/// The kinds that a layer process of Allen is built with.
pub fn kinds() -> Kinds {
    Kinds::default().with(MODULES.iter().copied())
}

/// The manifest of level 1.
pub fn wander_manifest() -> Source {
    Source::new("wander.toml", WANDER)
}

/// The manifest of level 2.
pub fn explore_manifest() -> Source {
    Source::new("explore.toml", EXPLORE)
}

/// The manifest `text`, which stands in `layers/allen` under that name.
pub fn manifest(name: &str, text: &str) -> Source {
    Source::new(name, text)
}
