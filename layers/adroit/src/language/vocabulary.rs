//! The primitives a body offers: the only names a program may use without saying what they are.

use crate::hierarchy::{CriterionId, McuId, StateId, StimulusId};

/// The stimulus every body has.
pub(crate) const ALWAYS: &str = "always";

/// Names of the primitive stimuli, goal criteria, goal states and MCUs of a body, in the order of their
/// numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Vocabulary {
    stimuli: Vec<String>,
    criteria: Vec<String>,
    states: Vec<String>,
    mcus: Vec<String>,
}

impl Vocabulary {
    /// A vocabulary. Stimuli are numbered from one: number zero is `always`, which every body has.
    #[must_use]
    pub fn new(stimuli: &[&str], criteria: &[&str], states: &[&str], mcus: &[&str]) -> Self {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let mut all = vec![ALWAYS.to_owned()];
        all.extend(owned(stimuli));
        Self {
            stimuli: all,
            criteria: owned(criteria),
            states: owned(states),
            mcus: owned(mcus),
        }
    }

    /// All stimuli, `always` first.
    pub fn stimuli(&self) -> impl Iterator<Item = &str> {
        self.stimuli.iter().map(String::as_str)
    }

    /// All goal criteria.
    pub fn criteria(&self) -> impl Iterator<Item = &str> {
        self.criteria.iter().map(String::as_str)
    }

    /// All goal states.
    pub fn states(&self) -> impl Iterator<Item = &str> {
        self.states.iter().map(String::as_str)
    }

    /// All MCUs.
    pub fn mcus(&self) -> impl Iterator<Item = &str> {
        self.mcus.iter().map(String::as_str)
    }

    /// The number of a stimulus.
    #[must_use]
    pub fn stimulus(&self, name: &str) -> Option<StimulusId> {
        place(&self.stimuli, name).map(StimulusId)
    }

    /// The number of a goal criterion.
    #[must_use]
    pub fn criterion(&self, name: &str) -> Option<CriterionId> {
        place(&self.criteria, name).map(CriterionId)
    }

    /// The number of a goal state.
    #[must_use]
    pub fn state(&self, name: &str) -> Option<StateId> {
        place(&self.states, name).map(StateId)
    }

    /// The number of an MCU.
    #[must_use]
    pub fn mcu(&self, name: &str) -> Option<McuId> {
        place(&self.mcus, name).map(McuId)
    }

    /// The name of a stimulus.
    #[must_use]
    pub fn stimulus_name(&self, stimulus: StimulusId) -> &str {
        &self.stimuli[usize::from(stimulus.0)]
    }

    /// The name of an MCU.
    #[must_use]
    pub fn mcu_name(&self, mcu: McuId) -> &str {
        &self.mcus[usize::from(mcu.0)]
    }
}

fn place(names: &[String], name: &str) -> Option<u16> {
    names
        .iter()
        .position(|known| known == name)
        .and_then(|place| u16::try_from(place).ok())
}
