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
        while let Some(action) = Self::next(backplane) {
            let outcome = action.do_action(body);
            Self::book(backplane, outcome);
            tried += 1;
        }
        tried
    }

    /// The action of the selected plan that comes next: the first without an outcome.
    pub fn next<C: Creature>(backplane: &CommunicationBackplane<C>) -> Option<C::Action> {
        let selected = backplane.selected()?;
        selected.plan.actions().get(selected.outcomes.len()).copied()
    }

    /// Books what came of [`Executor::next`], for a body that answers later than it is asked.
    ///
    /// # Panics
    /// When no action was under way.
    pub fn book<C: Creature>(backplane: &mut CommunicationBackplane<C>, outcome: C::Outcome) {
        assert!(Self::next(backplane).is_some(), "an outcome of no action");
        backplane.book_outcome(outcome);
    }
}
