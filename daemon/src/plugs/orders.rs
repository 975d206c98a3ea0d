//! Orders: what an attached layer is told to do with its own ports, and whether it does.
//!
//! ```text
//!   any thread: give ─► waiting ─► its caller's thread: next ─► given ─► answered
//!                                                                └─ no progress for 5 s: overdue, let go
//! ```
//! Must never make whoever gives an order wait for the layer.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard};

use ipc::clock::{Span, Time};
use ipc::control::Order;

/// Most orders that a layer has not answered: every tap of every other layer that may be attached (32 of 64 taps),
/// joined and let go again.
pub const ORDERS_MAX: usize = 4096;

/// How long a layer may take until it answers the next of its orders: it waits two seconds at most for the page of
/// another process and one for its own beat, and a busy host has to have room beside that.
pub const ORDER_TIME: Span = Span::secs(5);

/// The orders of one attached layer.
#[derive(Debug, Default)]
pub struct Orders {
    held: Mutex<Held>,
}

#[derive(Debug, Default)]
struct Held {
    waiting: VecDeque<(u64, Order)>,
    given: VecDeque<(u64, Order)>,
    last: u64,
    /// When there was something to do first, or an answer last.
    since: Time,
    /// Too many were given.
    flooded: bool,
}

impl Orders {
    fn lock(&self) -> MutexGuard<'_, Held> {
        self.held.lock().expect("nobody panics holding the orders")
    }

    /// Gives an order at `now`. If too many are open already it is not given, and the layer is overdue.
    pub fn give(&self, order: Order, now: Time) {
        let mut held = self.lock();
        let open = held.waiting.len() + held.given.len();
        if open >= ORDERS_MAX {
            held.flooded = true;
            return;
        }
        if open == 0 {
            held.since = now;
        }
        held.last += 1;
        let number = held.last;
        held.waiting.push_back((number, order));
    }

    /// The next order to be told, if there is one.
    pub fn next(&self) -> Option<(u64, Order)> {
        let mut held = self.lock();
        let next = held.waiting.pop_front()?;
        held.given.push_back(next.clone());
        Some(next)
    }

    /// The order that was answered at `now`; `None` if there is no such order.
    pub fn answered(&self, number: u64, now: Time) -> Option<Order> {
        let mut held = self.lock();
        let index = held.given.iter().position(|(n, _)| *n == number)?;
        held.since = now;
        held.given.remove(index).map(|(_, order)| order)
    }

    /// Whether the layer has not answered in time.
    pub fn overdue(&self, now: Time) -> bool {
        let held = self.lock();
        let open = held.waiting.len() + held.given.len();
        held.flooded || open > 0 && now.since(held.since) > ORDER_TIME
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(plug: u32) -> Order {
        Order::Release { plug }
    }

    #[test]
    fn a_layer_is_overdue_when_nothing_is_answered_not_when_much_is_to_be_done() {
        let orders = Orders::default();
        assert!(!orders.overdue(Time(u64::MAX)), "nothing to do");
        let begin = Time(1_000_000_000);
        (0..10).for_each(|plug| orders.give(order(plug), begin));
        for second in 1..=10 {
            let now = begin + Span::secs(4 * second);
            assert!(!orders.overdue(now), "progress at {second}");
            let (number, _) = orders.next().expect("ten orders");
            assert_eq!(orders.answered(number, now), Some(order(second as u32 - 1)));
            assert_eq!(orders.answered(number, now), None, "only once");
        }
        orders.give(order(9), begin + Span::secs(100));
        assert!(!orders.overdue(begin + Span::secs(105)));
        assert!(orders.overdue(begin + Span::secs(106)));
    }

    #[test]
    fn there_is_an_end_to_orders() {
        let orders = Orders::default();
        for _ in 0..ORDERS_MAX {
            orders.give(order(1), Time(1));
        }
        assert!(!orders.overdue(Time(1)));
        orders.give(order(1), Time(1));
        assert!(orders.overdue(Time(1)));
    }
}
