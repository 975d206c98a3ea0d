//! `difference`: one message less another.
//!
//! ```text
//!  out := a - b          emitted when a or b arrives and both were ever received
//! ```
//! Numbers and vectors, in one unit. A difference that is too large to be a number is not emitted.

use ipc::message::Vector;

use crate::pair::pair;

const ABOUT: &str = "takes b from a";
const DIAGRAM: &str = "out := a - b, when a or b arrives and both were ever received";

pair!(
    "difference" f64 => f64: |a, b| a - b,
    "difference.vector" Vector => Vector: |a, b| Vector { x: a.x - b.x, y: a.y - b.y },
);
