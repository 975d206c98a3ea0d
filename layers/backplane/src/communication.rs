//! The short-term memory, and the only channel between layers, selector and executor.

use arrayvec::ArrayVec;

use crate::{ACTIONS_MAX, ControlData, Creature, LayerId, PlanOfAction};

/// Layers of one creature at most. Truckin' has four; twice that leaves room.
pub const LAYERS_MAX: usize = 8;

/// Proposals, inhibitions and the selection of one creature (Gantchev 2001, 3.2,
/// *CommunicationBackplane*).
///
/// It is cleared after the feedback phase of every selection, so nothing in it is older than one
/// selection.
pub struct CommunicationBackplane<C: Creature> {
    control: ArrayVec<ControlData<C>, LAYERS_MAX>,
    selected: Option<LayerId>,
    outcomes: ArrayVec<C::Outcome, ACTIONS_MAX>,
}

/// The plan that was selected, by whom it was proposed, and what came of each of its actions.
pub struct Selected<'a, C: Creature> {
    /// The layer whose plan it was.
    pub layer: LayerId,
    /// The plan.
    pub plan: &'a PlanOfAction<C>,
    /// One outcome for each action carried out so far, in the order of the plan.
    pub outcomes: &'a [C::Outcome],
}

impl<C: Creature> CommunicationBackplane<C> {
    /// An empty memory for this many layers.
    ///
    /// # Panics
    /// When there are no layers or more than [`LAYERS_MAX`].
    pub fn new(layers: usize) -> Self {
        assert!(
            (1..=LAYERS_MAX).contains(&layers),
            "1 to {LAYERS_MAX} layers, not {layers}"
        );
        Self {
            control: (0..layers).map(|_| ControlData::new()).collect(),
            selected: None,
            outcomes: ArrayVec::new(),
        }
    }

    /// How many layers it serves.
    pub fn layers(&self) -> usize {
        self.control.len()
    }

    /// What it holds for one layer.
    pub fn control(&self, layer: LayerId) -> &ControlData<C> {
        &self.control[usize::from(layer.0)]
    }

    /// The plan flagged by the selector, with what has come of it; nothing when no layer had one.
    pub fn selected(&self) -> Option<Selected<'_, C>> {
        let layer = self.selected?;
        Some(Selected {
            layer,
            plan: self.control(layer).plan(),
            outcomes: &self.outcomes,
        })
    }

    /// Forgets proposals, inhibitions, selection and outcomes.
    pub fn clear(&mut self) {
        self.control.iter_mut().for_each(ControlData::clear);
        self.selected = None;
        self.outcomes.clear();
    }

    pub(crate) fn control_mut(&mut self, layer: LayerId) -> &mut ControlData<C> {
        &mut self.control[usize::from(layer.0)]
    }

    /// Flags the lowest layer that has a plan and is not inhibited.
    pub(crate) fn flag_by_priority(&mut self) -> Option<LayerId> {
        let lowest = self.control.iter().position(ControlData::may_be_selected)?;
        self.selected = Some(LayerId(lowest as u8));
        self.selected
    }

    pub(crate) fn book_outcome(&mut self, outcome: C::Outcome) {
        self.outcomes.push(outcome);
    }
}
