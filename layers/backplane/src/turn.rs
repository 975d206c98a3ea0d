//! A turn: select, execute, until the time slot is used up.

use crate::{BehaviourLayer, CommunicationBackplane, Creature, Executor, Selector};

/// Selections in one turn at most. Actions that cost no time could otherwise keep a turn going for
/// ever; a slot of ten minutes has room for ten of the shortest actions that cost any, and for a
/// trade before and after each.
pub const SELECTIONS_MAX: u32 = 32;

/// Why a turn ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnEnd {
    /// The time slot is used up.
    SlotUsedUp,
    /// No layer had a plan that was not inhibited.
    NothingToDo,
    /// [`SELECTIONS_MAX`] selections were made and there was still time.
    CutShort,
}

/// Plays one turn (Gantchev 2001, 3.3): repeats selection and execution until the slot is used up.
pub fn take_turn<C: Creature, L: BehaviourLayer<C>>(
    layers: &mut [L],
    backplane: &mut CommunicationBackplane<C>,
    body: &mut C::Body<'_>,
) -> TurnEnd {
    for _ in 0..SELECTIONS_MAX {
        if C::slot_is_used_up(body) {
            return TurnEnd::SlotUsedUp;
        }
        if Selector::select(layers, backplane, body).is_none() {
            return TurnEnd::NothingToDo;
        }
        Executor::execute(backplane, body);
    }
    TurnEnd::CutShort
}
