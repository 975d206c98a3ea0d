//! `quotient`: one number divided by another.
//!
//! ```text
//!  out := a / b          emitted when a or b arrives and both were ever received
//! ```
//! In the quotient of their units. A division by zero, or a quotient that is too large to be a number, emits
//! nothing; the state is then `refused`.

use crate::pair::pair;

const ABOUT: &str = "divides a by b; by zero: emits nothing";
const DIAGRAM: &str = "out := a / b, when a or b arrives and both were ever received";

pair!("quotient" f64 => f64: |a, b| a / b);
