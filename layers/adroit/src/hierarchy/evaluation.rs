//! One recursive evaluation, the same at every level of every hierarchy.
//!
//! ```text
//! level(given):
//!   1. every RM of the level sums its inputs, takes off its threshold, sends what is above zero
//!   2. the selector takes the largest output; nothing above zero: the level fails
//!   3. the RM looks for its goal; none, or a goal state that holds: output to zero, back to 2
//!   4. equal outputs: those that conflict are put to zero, back to 2; the others are chosen together
//!   5. control descends: MCU, subroutine or the level below; failure: output to zero, back to 2
//! ```
//!
//! Must never allocate, wait or read a clock. Source: *Internal structure of the RM and SRM*.

use super::arena::{Control, Hierarchy, LevelIndex, MechanismIndex};
use super::trace::Yielded;
use super::{CriterionId, DEPTH_MAX, Goal, McuId, OUTPUTS_MAX, StateId, StimulusId, WIDTH_MAX};

/// What a body lets its hierarchy see. All of it is answered from what is already known: no waiting.
pub trait Senses {
    /// Value of a processed stimulus, from 0 (absent) to 1 (fully there); `given` is the goal handed to
    /// the level that asks. Never called for [`StimulusId::ALWAYS`].
    fn stimulus(&self, stimulus: StimulusId, given: &Goal) -> f64;
    /// Goal parameters by a criterion, from goal-determining inputs; `None` if not all can be specified.
    fn select(&self, criterion: CriterionId, given: &Goal) -> Option<Goal>;
    /// Whether a goal state holds for a goal.
    fn holds(&self, state: StateId, goal: &Goal) -> bool;
}

/// An MCU put to work, with its goal parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Which unit.
    pub mcu: McuId,
    /// What it shall attain.
    pub goal: Goal,
    /// The terminating RM that called it.
    pub by: MechanismIndex,
}

impl Output {
    pub(super) const NONE: Self = Self {
        mcu: McuId(0),
        goal: Goal::NONE,
        by: MechanismIndex(0),
    };
}

/// How an evaluation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At least one MCU was put to work.
    Acting,
    /// Not even the top level found something to choose.
    Nothing,
}

/// Result of one evaluation from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evaluation {
    /// How it ended.
    pub outcome: Outcome,
    /// How many RMs were asked for their output.
    pub asked: u32,
}

impl Hierarchy {
    /// Evaluates the whole hierarchy from the top. To be called at the start, after every MCU output and,
    /// at once, on a priority interrupt.
    pub fn evaluate<S: Senses + ?Sized>(&mut self, senses: &S) -> Evaluation {
        self.number += 1;
        self.outputs_now = 0;
        self.asked = 0;
        let acting = self.evaluate_level(LevelIndex(0), &Goal::NONE, 0, senses);
        let outcome = if acting { Outcome::Acting } else { Outcome::Nothing };
        Evaluation {
            outcome,
            asked: self.asked,
        }
    }

    /// The MCUs put to work by the latest evaluation.
    #[must_use]
    pub fn outputs(&self) -> &[Output] {
        &self.outputs[..self.outputs_now]
    }

    /// Reports that an MCU could not do what it was called for: the RM that called it is put to zero in the
    /// next evaluation, which sets off the back-up.
    pub fn report_failure(&mut self, mcu: McuId) {
        for output in &self.outputs[..self.outputs_now] {
            if output.mcu == mcu {
                self.traces[usize::from(output.by.0)].refused = self.number + 1;
            }
        }
    }

    fn evaluate_level<S: Senses + ?Sized>(
        &mut self,
        level: LevelIndex,
        given: &Goal,
        depth: usize,
        senses: &S,
    ) -> bool {
        assert!(depth < DEPTH_MAX, "the checker bounds the depth");
        let level = self.levels[usize::from(level.0)];
        let (first, width) = (usize::from(level.first), usize::from(level.width));
        assert!(width <= WIDTH_MAX, "the checker bounds the width");
        for place in first..first + width {
            self.listen(place, given, senses);
        }
        while let Some(leaders) = self.leaders(first, width) {
            let candidates = self.able(first, leaders, given, senses);
            let chosen = self.without_conflicts(first, candidates);
            let mut succeeded = false;
            for offset in places(chosen) {
                succeeded |= self.activate(first + offset, depth, senses);
            }
            if succeeded {
                return true;
            }
        }
        false
    }

    /// Step 1 for one RM.
    fn listen<S: Senses + ?Sized>(&mut self, place: usize, given: &Goal, senses: &S) {
        let mechanism = &self.mechanisms[place];
        let start = mechanism.first_input as usize;
        let mut sum = 0.0;
        for input in &self.inputs[start..start + usize::from(mechanism.inputs)] {
            let value = if input.stimulus == StimulusId::ALWAYS {
                1.0
            } else {
                senses.stimulus(input.stimulus, given)
            };
            sum += value * input.magnitude;
        }
        let excitation = sum - mechanism.threshold;
        let trace = &mut self.traces[place];
        trace.excitation = excitation;
        trace.yielded = None;
        trace.listened = self.number;
        let mut output = if excitation > 0.0 { excitation } else { 0.0 };
        if trace.refused == self.number && output > 0.0 {
            output = 0.0;
            trace.yielded = Some(Yielded::Motor);
        }
        self.excited[place] = output;
        self.asked += 1;
    }

    /// Step 2: the RMs whose output is the largest above zero, one bit each. A value that is no number counts
    /// as nothing.
    fn leaders(&self, first: usize, width: usize) -> Option<u64> {
        let (mut largest, mut bits) = (0.0, 0);
        for (offset, &output) in self.excited[first..first + width].iter().enumerate() {
            if output > largest {
                (largest, bits) = (output, 1 << offset);
            } else if output == largest {
                bits |= 1 << offset;
            }
        }
        (largest > 0.0).then_some(bits)
    }

    /// Step 3: of the RMs with the largest output, those that have a goal yet to be reached; one bit each.
    fn able<S: Senses + ?Sized>(&mut self, first: usize, leaders: u64, given: &Goal, senses: &S) -> u64 {
        let mut able = 0;
        for offset in places(leaders) {
            let place = first + offset;
            match self.find_goal(place, given, senses) {
                Ok(goal) => {
                    self.traces[place].goal = goal;
                    able |= 1 << offset;
                }
                Err(why) => self.put_to_zero(place, why),
            }
        }
        able
    }

    fn find_goal<S: Senses + ?Sized>(&self, place: usize, given: &Goal, senses: &S) -> Result<Goal, Yielded> {
        let mechanism = &self.mechanisms[place];
        let trace = &self.traces[place];
        let stays = trace.active != 0 && trace.active + 1 == self.number;
        let goal = match mechanism.selection {
            None => *given,
            Some(selection) if selection.kept && stays => trace.goal,
            Some(selection) => senses.select(selection.criterion, given).ok_or(Yielded::NoGoal)?,
        };
        match mechanism.goal_state {
            Some(state) if senses.holds(state, &goal) => Err(Yielded::GoalHolds),
            _ => Ok(goal),
        }
    }

    /// Step 4: puts to zero every candidate that conflicts with another one.
    fn without_conflicts(&mut self, first: usize, candidates: u64) -> u64 {
        if candidates.count_ones() < 2 {
            return candidates;
        }
        let mut chosen = candidates;
        for offset in places(candidates) {
            let place = first + offset;
            if self.mechanisms[place].conflicts.0 & candidates != 0 {
                self.put_to_zero(place, Yielded::Conflict);
                chosen &= !(1 << offset);
            }
        }
        chosen
    }

    /// Step 5 for one RM.
    fn activate<S: Senses + ?Sized>(&mut self, place: usize, depth: usize, senses: &S) -> bool {
        let goal = self.traces[place].goal;
        let (succeeded, why) = match self.mechanisms[place].control {
            Control::Mcu(mcu) => (self.put_to_work(mcu, goal, place), Yielded::Motor),
            Control::Branch(level) | Control::Subroutine(level) => (
                self.evaluate_level(level, &goal, depth + 1, senses),
                Yielded::Below,
            ),
        };
        if succeeded {
            self.traces[place].active = self.number;
        } else {
            self.put_to_zero(place, why);
        }
        succeeded
    }

    /// An MCU serves one RM in an evaluation: who comes second, and wants something else, fails.
    fn put_to_work(&mut self, mcu: McuId, goal: Goal, place: usize) -> bool {
        if let Some(taken) = self.outputs().iter().find(|output| output.mcu == mcu) {
            return taken.goal == goal;
        }
        if self.outputs_now == OUTPUTS_MAX {
            return false;
        }
        let by = MechanismIndex(u16::try_from(place).expect("RMs are bounded by MECHANISMS_MAX"));
        self.outputs[self.outputs_now] = Output { mcu, goal, by };
        self.outputs_now += 1;
        true
    }

    fn put_to_zero(&mut self, place: usize, why: Yielded) {
        self.excited[place] = 0.0;
        self.traces[place].yielded = Some(why);
    }
}

/// The places of the bits that are set, from the lowest up.
fn places(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (bits != 0).then(|| bits.trailing_zeros() as usize)?;
        bits &= bits - 1;
        Some(place)
    })
}
