//! An ordered list of primitive actions.

use arrayvec::ArrayVec;

use crate::Creature;

/// Actions in one plan at most. The longest plan of a Truckin' layer is two legs of a journey with a
/// trade at each end, and a margin as large again.
pub const ACTIONS_MAX: usize = 8;

/// What a layer wants done, in order (Gantchev 2001, 3.2, *PlanOfAction*).
///
/// Holds its actions in place; adding to it never allocates.
pub struct PlanOfAction<C: Creature> {
    actions: ArrayVec<C::Action, ACTIONS_MAX>,
}

/// A plan already holds [`ACTIONS_MAX`] actions; the action was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanIsFull;

impl<C: Creature> PlanOfAction<C> {
    /// A plan with nothing in it.
    pub fn new() -> Self {
        Self {
            actions: ArrayVec::new(),
        }
    }

    /// Adds one action to the end.
    ///
    /// # Errors
    /// [`PlanIsFull`] when there is no room; the plan is unchanged.
    pub fn push(&mut self, action: C::Action) -> Result<(), PlanIsFull> {
        self.actions.try_push(action).map_err(|_| PlanIsFull)
    }

    /// The actions, first to last.
    pub fn actions(&self) -> &[C::Action] {
        &self.actions
    }

    /// Whether the plan proposes nothing.
    pub fn is_empty(&self) -> bool {
        self.actions.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.actions.clear();
    }
}

impl<C: Creature> Default for PlanOfAction<C> {
    fn default() -> Self {
        Self::new()
    }
}
