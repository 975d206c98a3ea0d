//! The flat arenas a hierarchy lives in: laid out once when it is loaded, never resized.

use super::trace::Trace;
use super::{CriterionId, McuId, OUTPUTS_MAX, Output, StateId, StimulusId};

/// Place of an RM in its hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MechanismIndex(pub u16);

/// Place of a level, and so of its selector, in its hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LevelIndex(pub u16);

/// The siblings an RM conflicts with, one bit for each place in its level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conflicts(pub u64);

/// One input of an RM: a processed stimulus and the magnitude it counts with; negative ones inhibit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Which stimulus of the body.
    pub stimulus: StimulusId,
    /// Factor on the value of the stimulus.
    pub magnitude: f64,
}

/// What an RM controls when it is active (source: *Interconnections and operation*).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// A branching RM: the level of its subordinates.
    Branch(LevelIndex),
    /// A terminating RM: a motor control unit.
    Mcu(McuId),
    /// A terminating RM: the first level of a subroutine shared with others.
    Subroutine(LevelIndex),
}

/// What the goal selection mechanism of an RM looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// Which criterion of the body picks the goal.
    pub criterion: CriterionId,
    /// Asked only on a new choice, and the goal then kept while the RM stays in control; otherwise every
    /// goal in view is reviewed at each evaluation.
    pub kept: bool,
}

/// The fixed part of an RM.
#[derive(Clone, Copy, Debug)]
pub struct Mechanism {
    /// First of its inputs in the arena of inputs.
    pub first_input: u32,
    /// How many inputs follow.
    pub inputs: u16,
    /// Taken from the sum of the inputs.
    pub threshold: f64,
    /// What its GSM looks for; without one the RM works on the goal it was given.
    pub selection: Option<Selection>,
    /// The state its GSM watches for; while it holds the RM does not act.
    pub goal_state: Option<StateId>,
    /// What it controls.
    pub control: Control,
    /// Siblings it conflicts with.
    pub conflicts: Conflicts,
    /// The level it stands in.
    pub level: LevelIndex,
}

/// One level: RMs that stand side by side in the arena, and the selector that chooses among them.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// First RM of the level.
    pub first: u16,
    /// How many RMs follow.
    pub width: u16,
}

/// What the loader hands over; kept apart so that only a checked program becomes a hierarchy.
pub(crate) struct Parts {
    pub(crate) mechanisms: Vec<Mechanism>,
    pub(crate) inputs: Vec<Input>,
    pub(crate) levels: Vec<Level>,
    pub(crate) names: Vec<String>,
    /// For each level, what stands above it: an RM, or the name of a subroutine, or nothing at the top.
    pub(crate) captions: Vec<String>,
}

/// A loaded hierarchy. Level 0 is the top. Loading allocates; [`Hierarchy::evaluate`] does not.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    pub(super) mechanisms: Box<[Mechanism]>,
    pub(super) inputs: Box<[Input]>,
    pub(super) levels: Box<[Level]>,
    pub(super) traces: Box<[Trace]>,
    /// Outputs of the RMs in the latest evaluation, apart from the traces: a selector reads those of its level
    /// once for each choice it makes.
    pub(super) excited: Box<[f64]>,
    pub(super) outputs: [Output; OUTPUTS_MAX],
    pub(super) outputs_now: usize,
    pub(super) number: u64,
    pub(super) asked: u32,
    names: Box<[String]>,
    captions: Box<[String]>,
}

impl Hierarchy {
    pub(crate) fn from_parts(parts: Parts) -> Self {
        assert!(
            !parts.levels.is_empty() && parts.levels[0].width > 0,
            "a hierarchy has a top level"
        );
        assert!(
            parts.mechanisms.len() <= super::MECHANISMS_MAX,
            "the checker bounds the RMs"
        );
        assert!(
            parts
                .levels
                .iter()
                .all(|level| usize::from(level.width) <= super::WIDTH_MAX)
        );
        let traces = vec![Trace::NEVER; parts.mechanisms.len()].into_boxed_slice();
        let excited = vec![0.0; parts.mechanisms.len()].into_boxed_slice();
        Self {
            mechanisms: parts.mechanisms.into_boxed_slice(),
            inputs: parts.inputs.into_boxed_slice(),
            levels: parts.levels.into_boxed_slice(),
            traces,
            excited,
            outputs: [Output::NONE; OUTPUTS_MAX],
            outputs_now: 0,
            number: 0,
            asked: 0,
            names: parts.names.into_boxed_slice(),
            captions: parts.captions.into_boxed_slice(),
        }
    }

    /// All RMs, level by level.
    #[must_use]
    pub fn mechanisms(&self) -> &[Mechanism] {
        &self.mechanisms
    }

    /// All levels; the first is the top.
    #[must_use]
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The places of the RMs of a level, left to right.
    pub fn members(&self, level: LevelIndex) -> impl Iterator<Item = MechanismIndex> + use<> {
        let level = self.levels[usize::from(level.0)];
        (level.first..level.first + level.width).map(MechanismIndex)
    }

    /// The inputs of an RM.
    #[must_use]
    pub fn inputs(&self, mechanism: MechanismIndex) -> &[Input] {
        let mechanism = &self.mechanisms[usize::from(mechanism.0)];
        let first = mechanism.first_input as usize;
        &self.inputs[first..first + usize::from(mechanism.inputs)]
    }

    /// The name of an RM.
    #[must_use]
    pub fn name(&self, mechanism: MechanismIndex) -> &str {
        &self.names[usize::from(mechanism.0)]
    }

    /// What stands above a level: `top`, an RM, or a subroutine.
    #[must_use]
    pub fn caption(&self, level: LevelIndex) -> &str {
        &self.captions[usize::from(level.0)]
    }

    /// The RM of a name. Subroutines are part of the same arena, so every name occurs once.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<MechanismIndex> {
        let place = self.names.iter().position(|known| known == name)?;
        u16::try_from(place).ok().map(MechanismIndex)
    }

    /// Takes over from a hierarchy that ran before what its RMs of the same names were doing, so that a
    /// command applied to a running hierarchy does not make it start anew.
    pub fn carry_over(&mut self, before: &Self) {
        let places = self.places_in(before);
        self.carry_over_at(before, &places);
    }

    /// For each RM its place in another hierarchy, if it has an RM of that name.
    #[must_use]
    pub fn places_in(&self, other: &Self) -> Box<[Option<MechanismIndex>]> {
        self.names.iter().map(|name| other.find(name)).collect()
    }

    /// [`carry_over`](Self::carry_over) with the places that [`places_in`](Self::places_in) found: nothing is
    /// searched nor allocated, so that a real-time thread may do it.
    ///
    /// # Panics
    /// When the places are not those of this hierarchy in that one.
    pub fn carry_over_at(&mut self, before: &Self, places: &[Option<MechanismIndex>]) {
        assert_eq!(places.len(), self.traces.len(), "one place for each RM");
        self.number = before.number;
        for (place, trace) in places.iter().zip(self.traces.iter_mut()) {
            if let Some(place) = place {
                *trace = before.traces[usize::from(place.0)];
            }
        }
    }

    /// Forgets every evaluation: the hierarchy is as it was loaded.
    pub fn forget(&mut self) {
        self.traces.fill(Trace::NEVER);
        self.outputs_now = 0;
        self.number = 0;
    }
}
