//! `product`: two numbers multiplied.
//!
//! ```text
//!  out := a * b          emitted when a or b arrives and both were ever received
//! ```
//! In the product of their units. A product that is too large to be a number is not emitted.

use crate::pair::pair;

const ABOUT: &str = "multiplies two numbers";
const DIAGRAM: &str = "out := a * b, when a or b arrives and both were ever received";

pair!("product" f64 => f64: |a, b| a * b);
