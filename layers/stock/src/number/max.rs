//! `max`: the larger of two numbers.
//!
//! ```text
//!  out := larger of a and b          emitted when a or b arrives and both were ever received
//! ```
//! In one unit.

use crate::pair::pair;

const ABOUT: &str = "emits the larger of two numbers";
const DIAGRAM: &str = "out := larger of a and b, when a or b arrives and both were ever received";

pair!("max" f64 => f64: f64::max);
