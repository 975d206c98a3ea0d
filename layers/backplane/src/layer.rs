//! One set of behaviours and subgoals, in two phases.

use crate::{CommunicationBackplane, ControlData, Creature, PlanIsFull, PlanOfAction, Selected};

/// A layer's rank in the fixed linear order; 0 is the lowest and goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LayerId(pub u8);

/// One set of behaviours and subgoals (Gantchev 2001, 3.2, *BehaviourLayer*).
///
/// A layer is a slot: whatever implements this trait plugs into it and touches nothing else. Both
/// phases may read the body and nothing more; only a selected plan acts.
pub trait BehaviourLayer<C: Creature> {
    /// First phase (`doFeedback`): what was chosen last time, and what the world has become.
    fn feedback(&mut self, heard: &Feedback<'_, C>, body: &C::Body<'_>);

    /// Second phase (`doGo`): propose a plan, and inhibit layers below if this one knows better.
    fn go(&mut self, proposal: &mut Proposal<'_, C>, body: &C::Body<'_>);
}

impl<C: Creature, L: BehaviourLayer<C> + ?Sized> BehaviourLayer<C> for Box<L> {
    fn feedback(&mut self, heard: &Feedback<'_, C>, body: &C::Body<'_>) {
        (**self).feedback(heard, body);
    }

    fn go(&mut self, proposal: &mut Proposal<'_, C>, body: &C::Body<'_>) {
        (**self).go(proposal, body);
    }
}

/// What a layer may learn from the backplane in its feedback phase.
pub struct Feedback<'a, C: Creature> {
    backplane: &'a CommunicationBackplane<C>,
    layer: LayerId,
}

impl<'a, C: Creature> Feedback<'a, C> {
    pub(crate) fn new(backplane: &'a CommunicationBackplane<C>, layer: LayerId) -> Self {
        Self { backplane, layer }
    }

    /// The plan selected last time and what came of it.
    pub fn selected(&self) -> Option<Selected<'a, C>> {
        self.backplane.selected()
    }

    /// Whether it was this layer's own plan.
    pub fn was_mine(&self) -> bool {
        self.backplane
            .selected()
            .is_some_and(|selected| selected.layer == self.layer)
    }

    /// What this layer proposed last time and whether it was inhibited.
    pub fn my_control(&self) -> &'a ControlData<C> {
        self.backplane.control(self.layer)
    }
}

/// Where a layer writes in its go phase.
pub struct Proposal<'a, C: Creature> {
    backplane: &'a mut CommunicationBackplane<C>,
    layer: LayerId,
}

impl<'a, C: Creature> Proposal<'a, C> {
    pub(crate) fn new(backplane: &'a mut CommunicationBackplane<C>, layer: LayerId) -> Self {
        Self { backplane, layer }
    }

    /// The rank of the layer that writes here.
    pub fn layer(&self) -> LayerId {
        self.layer
    }

    /// Adds one action to this layer's plan.
    ///
    /// # Errors
    /// [`PlanIsFull`] when the plan has no room left.
    pub fn add(&mut self, action: C::Action) -> Result<(), PlanIsFull> {
        self.backplane.control_mut(self.layer).plan.push(action)
    }

    /// This layer's plan so far.
    pub fn plan(&self) -> &PlanOfAction<C> {
        self.backplane.control(self.layer).plan()
    }

    /// What a layer below has proposed in this selection.
    ///
    /// # Panics
    /// When `layer` is not below this one.
    pub fn below(&self, layer: LayerId) -> &ControlData<C> {
        assert!(layer < self.layer, "{layer:?} is not below {:?}", self.layer);
        self.backplane.control(layer)
    }

    /// Inhibits one layer below: its plan will not be selected this time.
    ///
    /// # Panics
    /// When `layer` is not below this one. A layer that could inhibit upwards would turn the fixed
    /// order round.
    pub fn inhibit(&mut self, layer: LayerId) {
        assert!(layer < self.layer, "{layer:?} is not below {:?}", self.layer);
        self.backplane.control_mut(layer).inhibited = true;
    }

    /// Inhibits every layer below.
    pub fn inhibit_all_below(&mut self) {
        for below in 0..self.layer.0 {
            self.backplane.control_mut(LayerId(below)).inhibited = true;
        }
    }
}
