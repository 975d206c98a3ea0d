//! The telephone: what a call to another corner costs, in minutes and cents (Gantchev 2001, 2.1.2.5).

use super::dealers::Kind;
use super::rules::{CALL_CENTS, CALL_MINUTES, FAILED_CALL_CENTS, FAILED_CALL_MINUTES};

/// Minutes and cents of a call to a dealer of this kind. A call fails, and is cheap, when the dealer
/// there trades nothing.
pub fn cost(kind: Kind) -> (i32, i64) {
    match kind {
        Kind::Idle => (FAILED_CALL_MINUTES, FAILED_CALL_CENTS),
        Kind::Producer | Kind::Retailer | Kind::Consumer | Kind::GasStation => (CALL_MINUTES, CALL_CENTS),
    }
}
