//! Drawings of the hierarchies that run, for a page that lights the lamps of their RMs.
//!
//! Must never be asked for on a thread that beats.

use adroit::draw::svg;
use adroit::hierarchy::MechanismIndex;
use adroit::language::Running;

use crate::desk;
use crate::programs::built_in;

/// A hierarchy drawn in the manner of the source's figure 1.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The picture; the box of each RM says its number as `data-rm`.
    pub svg: String,
    /// The names of the RMs in the order of their numbers.
    pub names: Vec<String>,
}

/// The hierarchy that a module of a kind runs, if it is a kind of this crate: the desk's with all that was commanded,
/// or the built-in one.
#[must_use]
pub fn drawing(kind: &str) -> Option<Drawing> {
    let built_in = built_in(kind)?;
    Some(desk::looked_at(draw).unwrap_or_else(|| draw(&built_in.running())))
}

fn draw(running: &Running) -> Drawing {
    let hierarchy = running.hierarchy();
    let places = hierarchy
        .levels()
        .iter()
        .flat_map(|level| level.first..level.first + level.width);
    let names = places.map(|place| hierarchy.name(MechanismIndex(place)).to_owned());
    Drawing {
        svg: svg(hierarchy, running.vocabulary()),
        names: names.collect(),
    }
}
