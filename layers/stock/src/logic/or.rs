//! `or`: whether one bit is true, or both.
//!
//! ```text
//!  out := a or b          emitted when a or b arrives and both were ever received
//! ```
//! | a | b | out |
//! | - | - | --- |
//! | 0 | 0 | 0 |
//! | 0 | 1 | 1 |
//! | 1 | 0 | 1 |
//! | 1 | 1 | 1 |

use crate::pair::pair;

const ABOUT: &str = "true when one of two bits is, or both";
const DIAGRAM: &str = "out := a or b, when a or b arrives and both were ever received";

pair!("or" bool => bool: |a, b| a || b);
