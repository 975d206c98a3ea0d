//! What each RM did in the latest evaluation: for the eye, for learning, and for goals that are kept.

use super::{Goal, Hierarchy, LevelIndex, MechanismIndex};

/// Why an RM with an output above zero was not active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Yielded {
    /// Its GSM found no goal parameters.
    NoGoal,
    /// Its goal state held already.
    GoalHolds,
    /// Everything below it failed.
    Below,
    /// Its MCU reported failure, or was taken by an RM active beside it.
    Motor,
    /// It conflicts with an RM of the same output.
    Conflict,
}

/// What an RM did, stamped with evaluation numbers so that nothing needs to be cleared.
#[derive(Clone, Copy, Debug)]
pub struct Trace {
    pub(super) listened: u64,
    pub(super) active: u64,
    pub(super) refused: u64,
    pub(super) excitation: f64,
    pub(super) yielded: Option<Yielded>,
    pub(super) goal: Goal,
}

impl Trace {
    /// Of an RM that was never evaluated.
    pub(super) const NEVER: Self = Self {
        listened: 0,
        active: 0,
        refused: 0,
        excitation: 0.0,
        yielded: None,
        goal: Goal::NONE,
    };
}

impl Hierarchy {
    /// How many evaluations there have been.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether the RM's inputs were open in the latest evaluation.
    #[must_use]
    pub fn listens(&self, mechanism: MechanismIndex) -> bool {
        self.number > 0 && self.trace(mechanism).listened == self.number
    }

    /// Whether the RM was in control in the latest evaluation.
    #[must_use]
    pub fn active(&self, mechanism: MechanismIndex) -> bool {
        self.number > 0 && self.trace(mechanism).active == self.number
    }

    /// Sum of its inputs less the threshold, as its selector first saw it; zero if it did not listen.
    #[must_use]
    pub fn excitation(&self, mechanism: MechanismIndex) -> f64 {
        if self.listens(mechanism) {
            self.trace(mechanism).excitation
        } else {
            0.0
        }
    }

    /// Why it yielded in the latest evaluation, if it did.
    #[must_use]
    pub fn yielded(&self, mechanism: MechanismIndex) -> Option<Yielded> {
        if self.listens(mechanism) {
            self.trace(mechanism).yielded
        } else {
            None
        }
    }

    /// The goal it was working on, if it was active.
    #[must_use]
    pub fn goal(&self, mechanism: MechanismIndex) -> Option<Goal> {
        self.active(mechanism).then(|| self.trace(mechanism).goal)
    }

    /// The chain of active RMs from the top down, through subroutines; where several were active side by
    /// side, the first of them.
    pub fn active_path(&self) -> impl Iterator<Item = MechanismIndex> + '_ {
        let mut level = Some(LevelIndex(0));
        std::iter::from_fn(move || {
            let found = self.members(level?).find(|&member| self.active(member))?;
            level = self.below(found);
            Some(found)
        })
    }

    /// The level an RM opens when it is active.
    #[must_use]
    pub fn below(&self, mechanism: MechanismIndex) -> Option<LevelIndex> {
        match self.mechanisms[usize::from(mechanism.0)].control {
            super::Control::Branch(level) | super::Control::Subroutine(level) => Some(level),
            super::Control::Mcu(_) => None,
        }
    }

    fn trace(&self, mechanism: MechanismIndex) -> &Trace {
        &self.traces[usize::from(mechanism.0)]
    }
}
