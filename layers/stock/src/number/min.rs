//! `min`: the smaller of two numbers.
//!
//! ```text
//!  out := smaller of a and b          emitted when a or b arrives and both were ever received
//! ```
//! In one unit.

use crate::pair::pair;

const ABOUT: &str = "emits the smaller of two numbers";
const DIAGRAM: &str = "out := smaller of a and b, when a or b arrives and both were ever received";

pair!("min" f64 => f64: f64::min);
