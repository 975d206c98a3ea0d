//! Offices nobody has seen before: a floor plan from a seed, as the text that `layout_text` reads.
//!
//! ```text
//!  ┌──────┬───────┬──────┐   rooms along all four sides, a ring of corridor, a core of rooms within;
//!  │      │       │      │   a door to the corridor for each room, some between rooms, most with leaves;
//!  ├──  ──┴─  ────┴─  ───┤   some walls of glass, some polished; desks, tables, cabinets, chairs,
//!  │   ┌──  ─┬──  ──┐    │   screens with narrow gaps, things left in the corridor
//!  ├─  │     │      │  ──┤
//!  │   └─────┴──────┘    │
//!  ├──  ──┬─  ───┬─  ────┤
//!  └──────┴──────┴───────┘
//! ```
//! Every plan that comes out can be walked: all way points are within reach of each other. What the plan
//! is used for is nobody's business here.

mod furniture;
mod plan;
mod text;

use crate::layout::Layout;
use crate::noise::{Noise, Use};

/// Plans drawn before giving up: about one in four has a way point that furniture bars.
const DRAWS_MAX: u64 = 64;

/// The text of the office that belongs to `seed`: equal seeds give equal texts.
///
/// # Panics
/// If none of the plans drawn can be walked; no such seed is known.
pub fn generate(seed: u64) -> String {
    let mut refused = String::new();
    for draw in 0..DRAWS_MAX {
        let mut noise = Noise::new(seed.wrapping_mul(DRAWS_MAX).wrapping_add(draw), Use::Layout);
        let mut plan = plan::draw(&mut noise);
        furniture::furnish(&mut plan, &mut noise);
        let text = text::write(seed, &plan);
        match Layout::parse(&text) {
            Ok(_) => return text,
            Err(error) => refused = error.to_string(),
        }
    }
    panic!("no office for seed {seed}: {refused}")
}
