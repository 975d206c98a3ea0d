//! Metrics: the numbers of a running creature as OpenMetrics text, for Prometheus and its kin.
//!
//! Must never ask a real-time thread: everything comes from the status that the watcher gathers anyway.

#[cfg(test)]
mod rules;
mod serve;
mod text;

pub use serve::{Endpoint, Metrics, serve};
pub use text::text;
