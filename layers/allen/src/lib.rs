//! Allen: the first robot of Brooks 1991 §6.2 and figure 2, level by level.
//!
//! Level 0, [`level0`], keeps the robot from hitting things; level 1, [`level1`], makes it wander; level 2,
//! [`level2`], sets out for distant places. Each module is one file with its diagram. The wiring stands in
//! `allen.toml` and, for levels as processes of their own, in `wander.toml` and `explore.toml`.
//!
//! Must never know the body: it meets it on wires.

pub mod geometry;
pub mod level0;
pub mod level1;
pub mod level2;

use afsm::{Kinds, ModuleKind};
use ipc::wiring::Source;

/// Allen with level 0 alone, open to taps of further levels.
pub const CREATURE: &str = include_str!("../allen.toml");

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
];

/// Level 2 as the manifest of a layer process.
pub const EXPLORE: &str = include_str!("../explore.toml");

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
