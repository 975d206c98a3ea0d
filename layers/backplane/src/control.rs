//! What the backplane holds for one layer.

use crate::{Creature, PlanOfAction};

/// A layer's proposed plan and whether it is inhibited (Gantchev 2001, 3.2, *ControlData*).
pub struct ControlData<C: Creature> {
    pub(crate) plan: PlanOfAction<C>,
    pub(crate) inhibited: bool,
}

impl<C: Creature> ControlData<C> {
    pub(crate) fn new() -> Self {
        Self {
            plan: PlanOfAction::new(),
            inhibited: false,
        }
    }

    /// The plan the layer proposed; empty when it proposed none.
    pub fn plan(&self) -> &PlanOfAction<C> {
        &self.plan
    }

    /// Whether a layer above has inhibited this one.
    pub fn is_inhibited(&self) -> bool {
        self.inhibited
    }

    /// Whether the selector may choose this plan.
    pub fn may_be_selected(&self) -> bool {
        !self.inhibited && !self.plan.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.plan.clear();
        self.inhibited = false;
    }
}
