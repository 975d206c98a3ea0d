//! A turn in steps, for a body that is reached over wires and answers later than it is asked.
//!
//! ```text
//!  Idle ──begin──► Hear ──► Clear ──► Propose ──► Select ──a layer holds──► Act ──the plan is done──► Hear
//!                   │                                └──nobody──► Over       └──slot used up, cut short──► Over
//!                   └──slot used up already──► Over ──begin──► Hear
//! ```
//! It plays what [`take_turn`](crate::take_turn) plays, to the last outcome; only that each phase is a step of its
//! own and each action waits for its answer. Must never act on the body: it says what is to be done.

use crate::{BehaviourLayer, CommunicationBackplane, Creature, Executor, SELECTIONS_MAX, Selector, TurnEnd};

/// Where a turn stands: what [`SteppedTurn::step`] does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// No turn has begun yet.
    Idle,
    /// Feedback of every layer.
    Hear,
    /// The short-term memory is cleared.
    Clear,
    /// Go of every layer.
    Propose,
    /// The lowest plan that is not inhibited is flagged.
    Select,
    /// The selected plan is carried out: [`SteppedTurn::wanted`] is to be done and then told.
    Act,
    /// The turn is over.
    Over(TurnEnd),
}

/// A turn that is taken step by step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SteppedTurn {
    phase: Phase,
    /// Selections in this turn so far.
    selections: u32,
}

impl Default for SteppedTurn {
    fn default() -> Self {
        Self {
            phase: Phase::Idle,
            selections: 0,
        }
    }
}

impl SteppedTurn {
    /// Where it stands.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// A new turn begins, whatever became of the last one.
    pub fn begin<C: Creature>(&mut self, body: &C::Body<'_>) {
        self.selections = 0;
        self.go_on::<C>(body);
    }

    /// Does one phase. In [`Phase::Act`], `Idle` and `Over` nothing happens here: those wait for others.
    pub fn step<C: Creature, L: BehaviourLayer<C>>(
        &mut self,
        layers: &mut [L],
        backplane: &mut CommunicationBackplane<C>,
        body: &C::Body<'_>,
    ) {
        match self.phase {
            Phase::Hear => {
                Selector::hear(layers, backplane, body);
                self.phase = Phase::Clear;
            }
            Phase::Clear => {
                backplane.clear();
                self.phase = Phase::Propose;
            }
            Phase::Propose => {
                Selector::propose(layers, backplane, body);
                self.phase = Phase::Select;
            }
            Phase::Select => {
                self.selections += 1;
                self.phase = match Selector::flag(backplane) {
                    Some(_) => Phase::Act,
                    None => Phase::Over(TurnEnd::NothingToDo),
                };
            }
            Phase::Idle | Phase::Act | Phase::Over(_) => {}
        }
    }

    /// The action the body is to do now.
    pub fn wanted<C: Creature>(&self, backplane: &CommunicationBackplane<C>) -> Option<C::Action> {
        match self.phase {
            Phase::Act => Executor::next(backplane),
            _ => None,
        }
    }

    /// Takes in what came of the action that was wanted; `body` is as it was left by it.
    ///
    /// # Panics
    /// When no action was wanted.
    pub fn answered<C: Creature>(
        &mut self,
        backplane: &mut CommunicationBackplane<C>,
        outcome: C::Outcome,
        body: &C::Body<'_>,
    ) {
        Executor::book(backplane, outcome);
        if Executor::next(backplane).is_none() {
            self.go_on::<C>(body);
        }
    }

    /// Another selection, if there is time for one.
    fn go_on<C: Creature>(&mut self, body: &C::Body<'_>) {
        self.phase = if self.selections == SELECTIONS_MAX {
            Phase::Over(TurnEnd::CutShort)
        } else if C::slot_is_used_up(body) {
            Phase::Over(TurnEnd::SlotUsedUp)
        } else {
            Phase::Hear
        };
    }
}
