//! `and`: whether both bits are true.
//!
//! ```text
//!  out := a and b          emitted when a or b arrives and both were ever received
//! ```
//! | a | b | out |
//! | - | - | --- |
//! | 0 | 0 | 0 |
//! | 0 | 1 | 0 |
//! | 1 | 0 | 0 |
//! | 1 | 1 | 1 |

use crate::pair::pair;

const ABOUT: &str = "true when both bits are";
const DIAGRAM: &str = "out := a and b, when a or b arrives and both were ever received";

pair!("and" bool => bool: |a, b| a && b);
