//! Runs the two phases and chooses by fixed priority.

use crate::{BehaviourLayer, CommunicationBackplane, Creature, Feedback, LayerId, Proposal};

/// Controls the deliberation of the layers (Gantchev 2001, 3.2, *Selector*).
pub struct Selector;

impl Selector {
    /// One selection: (1) feedback of every layer, (2) clear the short-term memory, (3) go of every
    /// layer, (4) flag the lowest plan that is not inhibited. Returns the layer that holds the
    /// creature now, or nothing when no layer has a plan it may carry out.
    ///
    /// Layers are called from the lowest up; `layers[k]` is the layer of rank `k`.
    ///
    /// # Panics
    /// When the number of layers is not the one the backplane was made for.
    pub fn select<C: Creature, L: BehaviourLayer<C>>(
        layers: &mut [L],
        backplane: &mut CommunicationBackplane<C>,
        body: &C::Body<'_>,
    ) -> Option<LayerId> {
        Self::hear(layers, backplane, body);
        backplane.clear();
        Self::propose(layers, backplane, body);
        Self::flag(backplane)
    }

    /// The first phase alone: feedback of every layer.
    ///
    /// # Panics
    /// When the number of layers is not the one the backplane was made for.
    pub fn hear<C: Creature, L: BehaviourLayer<C>>(
        layers: &mut [L],
        backplane: &CommunicationBackplane<C>,
        body: &C::Body<'_>,
    ) {
        assert_eq!(layers.len(), backplane.layers(), "one ControlData for each layer");
        for (rank, layer) in layers.iter_mut().enumerate() {
            layer.feedback(&Feedback::new(backplane, LayerId(rank as u8)), body);
        }
    }

    /// The second phase alone: go of every layer, on a backplane that was cleared.
    ///
    /// # Panics
    /// When the number of layers is not the one the backplane was made for.
    pub fn propose<C: Creature, L: BehaviourLayer<C>>(
        layers: &mut [L],
        backplane: &mut CommunicationBackplane<C>,
        body: &C::Body<'_>,
    ) {
        assert_eq!(layers.len(), backplane.layers(), "one ControlData for each layer");
        for (rank, layer) in layers.iter_mut().enumerate() {
            layer.go(&mut Proposal::new(backplane, LayerId(rank as u8)), body);
        }
    }

    /// The choice alone: flags the lowest plan that is not inhibited.
    pub fn flag<C: Creature>(backplane: &mut CommunicationBackplane<C>) -> Option<LayerId> {
        backplane.flag_by_priority()
    }
}
