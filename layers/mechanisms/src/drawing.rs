//! Drawings of the built-in hierarchies, for a page that lights the lamps of their RMs.
//!
//! Must never be asked for on a thread that beats.

use adroit::draw::svg;
use adroit::language::load;
use adroit::{drives as allen, nest as builder};

/// A hierarchy drawn in the manner of the source's figure 1.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The picture; the box of each RM says its number as `data-rm`.
    pub svg: String,
    /// The names of the RMs in the order of their numbers.
    pub names: Vec<String>,
}

/// The built-in hierarchy of a kind of module, if it is one of this crate.
#[must_use]
pub fn drawing(kind: &str) -> Option<Drawing> {
    let (program, vocabulary) = match kind {
        "mechanisms.nest" => (builder::PROGRAM, builder::vocabulary()),
        "mechanisms.drives" => (allen::PROGRAM, allen::vocabulary()),
        _ => return None,
    };
    let hierarchy = load(program, &vocabulary).expect("the programs are tested");
    let places = hierarchy
        .levels()
        .iter()
        .flat_map(|level| level.first..level.first + level.width);
    let names = places.map(|place| {
        hierarchy
            .name(adroit::hierarchy::MechanismIndex(place))
            .to_owned()
    });
    Some(Drawing {
        svg: svg(&hierarchy, &vocabulary),
        names: names.collect(),
    })
}
