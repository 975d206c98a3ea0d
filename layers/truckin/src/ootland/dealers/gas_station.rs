//! A gas station: sells gas without limit at the price it opened with.

/// A dealer who sells GAS.
#[derive(Clone, Debug, Default)]
pub struct GasStation;

impl GasStation {
    /// Lets the slot go by; its tanks are full whatever is sold.
    pub fn play(&mut self) {}
}
