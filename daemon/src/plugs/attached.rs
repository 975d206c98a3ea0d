//! Attached layers as the daemon knows them.
//!
//! Must never hold what only the layer's process knows: that is told from outside, and may be wrong.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ipc::control::{Plug, PlugTap};
use ipc::wire::{Page, Reader, TapCounts, TapGauge};

use super::orders::Orders;
use crate::flow::Flow;

/// An attached layer, as its connection knows it.
#[derive(Debug)]
pub struct Joined {
    /// Its number.
    pub number: u32,
    /// Set when it is let go against its will.
    pub dismissed: Arc<AtomicBool>,
    /// What it is to do.
    pub orders: Arc<Orders>,
}

/// A tap that an attached layer holds.
#[derive(Clone, Debug)]
pub struct AttachedTap {
    /// As asked for.
    pub tap: PlugTap,
    /// Where what happens at it is counted.
    pub gauge: Arc<TapGauge>,
    /// Its messages.
    pub reader: Reader,
    /// The attached layer at whose port it acts; none for a layer of the daemon's own.
    pub at: Option<String>,
    /// Whether it stands there. At the port of an attached layer it waits for that to say so, and to come back
    /// when it has gone.
    pub joined: bool,
    /// What was counted there before that layer came last.
    pub(super) before: TapCounts,
}

/// An attached layer.
#[derive(Clone, Debug)]
pub struct Attached {
    /// Its number.
    pub number: u32,
    /// As asked for.
    pub plug: Plug,
    /// Its wires.
    pub page: Arc<Page>,
    /// Its taps.
    pub taps: Vec<AttachedTap>,
    /// Set when it is let go against its will: its connection is closed then.
    pub dismissed: Arc<AtomicBool>,
    /// What it is to do.
    pub(super) orders: Arc<Orders>,
    pub(super) flows: Vec<Flow>,
}
