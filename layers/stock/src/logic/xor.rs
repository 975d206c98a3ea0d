//! `xor`: whether one bit is true and the other is not.
//!
//! ```text
//!  out := a xor b          emitted when a or b arrives and both were ever received
//! ```
//! | a | b | out |
//! | - | - | --- |
//! | 0 | 0 | 0 |
//! | 0 | 1 | 1 |
//! | 1 | 0 | 1 |
//! | 1 | 1 | 0 |

use crate::pair::pair;

const ABOUT: &str = "true when two bits differ";
const DIAGRAM: &str = "out := a xor b, when a or b arrives and both were ever received";

pair!("xor" bool => bool: |a, b| a != b);
