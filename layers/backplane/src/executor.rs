//! Carries out the selected plan.

use crate::{Action, CommunicationBackplane, Creature};

/// Carries out the selected plan, action by action (Gantchev 2001, 3.2, *Executor*).
pub struct Executor;

impl Executor {
    /// Does every action of the selected plan in order and books what came of each on the backplane.
    ///
    /// An action the body refuses does not stop the ones after it: the body screens each by itself,
    /// and the layers find out in their next feedback phase. Returns how many actions were tried.
    pub fn execute<C: Creature>(backplane: &mut CommunicationBackplane<C>, body: &mut C::Body<'_>) -> usize {
        let mut tried = 0;
        while let Some(&action) = backplane
            .selected()
            .and_then(|selected| selected.plan.actions().get(tried))
        {
            let outcome = action.do_action(body);
            backplane.book_outcome(outcome);
            tried += 1;
        }
        tried
    }
}
