//! A program as its names: what the statements, taken in their order, add up to.

use super::problem::{Position, Problem, Problems};
use super::statement::{Stated, Statement};

/// What an RM reports to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Superordinate {
    /// Nothing: it stands at the top.
    Top,
    /// A branching RM.
    Rm(Stated),
    /// A subroutine, at its first level.
    Subroutine(Stated),
}

/// What a program says about one RM.
#[derive(Clone, Debug)]
pub struct Declared {
    /// Its name, where it was first said what it reports to.
    pub name: Stated,
    /// What it reports to.
    pub superordinate: Superordinate,
    /// Its stimuli with their magnitudes.
    pub inputs: Vec<(Stated, f64)>,
    /// Its threshold.
    pub threshold: f64,
    /// The goal criterion of its GSM, and whether the goal is kept.
    pub selection: Option<(Stated, bool)>,
    /// Its goal state.
    pub goal_state: Option<Stated>,
    /// The MCU that reports to it.
    pub mcu: Option<Stated>,
    /// The subroutine its goal parameters go to.
    pub subroutine: Option<Stated>,
    /// RMs it conflicts with, as it says itself.
    pub conflicts: Vec<Stated>,
}

/// A program: its RMs in the order in which they are introduced.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// All RMs.
    pub rms: Vec<Declared>,
}

impl Program {
    /// The RM of a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Declared> {
        self.rms.iter().find(|rm| rm.name.name == name)
    }

    /// Takes the statements in their order. An RM exists from the statement on that says what it reports to,
    /// but other statements about it may stand anywhere in the text before.
    ///
    /// # Errors
    /// Statements that say something twice, or take away what is not there.
    pub(crate) fn assemble(statements: &[Statement]) -> Result<Self, Problems> {
        let mut program = Self::default();
        let mut problems = Vec::new();
        let mut said_early = Vec::new();
        for statement in statements {
            if let Err(problem) = program.take(statement) {
                match problem {
                    Refused::NotYet => said_early.push(statement),
                    Refused::Wrong(problem) => problems.push(problem),
                }
            }
        }
        for statement in said_early {
            match program.take(statement) {
                Ok(()) => {}
                Err(Refused::Wrong(problem)) => problems.push(problem),
                Err(Refused::NotYet) => {
                    let rm = subject(statement);
                    let known = program.rms.iter().map(|known| known.name.name.as_str());
                    let message = format!(
                        "there is no rm `{rm}`; expected the name of an rm that reports to something"
                    );
                    problems.push(Problem::new(rm.at, message).near(&rm.name, known));
                }
            }
        }
        Problems::none_of(problems)?;
        Ok(program)
    }

    fn take(&mut self, statement: &Statement) -> Result<(), Refused> {
        match statement {
            Statement::ReportsToTop { rm } => self.introduce(rm, Superordinate::Top),
            Statement::ReportsToRm { rm, superordinate } => {
                self.introduce(rm, Superordinate::Rm(superordinate.clone()))
            }
            Statement::ReportsToSubroutine { rm, subroutine } => {
                self.introduce(rm, Superordinate::Subroutine(subroutine.clone()))
            }
            Statement::RemoveRm { rm } => self.remove(rm),
            about => {
                let rm = subject(about);
                let declared = self
                    .rms
                    .iter_mut()
                    .find(|known| known.name.name == rm.name)
                    .ok_or(Refused::NotYet)?;
                declared.take(about).map_err(Refused::Wrong)
            }
        }
    }

    fn introduce(&mut self, rm: &Stated, superordinate: Superordinate) -> Result<(), Refused> {
        if let Some(known) = self.find(&rm.name) {
            let message = format!(
                "rm `{rm}` reports to something already, at line {}",
                known.name.at.line
            );
            return Err(Refused::Wrong(Problem::new(rm.at, message)));
        }
        self.rms.push(Declared {
            name: rm.clone(),
            superordinate,
            inputs: Vec::new(),
            threshold: 0.0,
            selection: None,
            goal_state: None,
            mcu: None,
            subroutine: None,
            conflicts: Vec::new(),
        });
        Ok(())
    }

    fn remove(&mut self, rm: &Stated) -> Result<(), Refused> {
        let place = self
            .rms
            .iter()
            .position(|known| known.name.name == rm.name)
            .ok_or(Refused::NotYet)?;
        let above =
            |known: &Declared| matches!(&known.superordinate, Superordinate::Rm(up) if up.name == rm.name);
        if let Some(below) = self.rms.iter().find(|known| above(known)) {
            let message = format!("rm `{rm}` cannot be removed: rm `{}` reports to it", below.name);
            return Err(Refused::Wrong(Problem::new(rm.at, message)));
        }
        self.rms.remove(place);
        for known in &mut self.rms {
            known.conflicts.retain(|other| other.name != rm.name);
        }
        Ok(())
    }
}

enum Refused {
    NotYet,
    Wrong(Problem),
}

impl Declared {
    fn take(&mut self, statement: &Statement) -> Result<(), Problem> {
        match statement {
            Statement::AddStimulus {
                stimulus, magnitude, ..
            } => {
                if let Some((before, _)) = self.inputs.iter().find(|(known, _)| known.name == stimulus.name) {
                    return Err(twice(
                        stimulus,
                        &format!("an input of rm `{}`", self.name),
                        before.at,
                    ));
                }
                self.inputs.push((stimulus.clone(), *magnitude));
            }
            Statement::RemoveStimulus { stimulus, .. } => {
                let known = self.inputs.iter().map(|(known, _)| known.name.as_str());
                let Some(place) = known.clone().position(|known| known == stimulus.name) else {
                    let message = format!("stimulus `{stimulus}` is no input of rm `{}`", self.name);
                    return Err(Problem::new(stimulus.at, message).near(&stimulus.name, known));
                };
                self.inputs.remove(place);
            }
            Statement::McuReports { mcu, .. } => set(&mut self.mcu, mcu, "the mcu of its rm")?,
            Statement::GoesToSubroutine { subroutine, .. } => {
                set(&mut self.subroutine, subroutine, "the subroutine of its rm")?;
            }
            Statement::SelectsGoal { criterion, .. } => self.selection = Some((criterion.clone(), false)),
            Statement::KeepsGoal { criterion, .. } => self.selection = Some((criterion.clone(), true)),
            Statement::GoalState { state, .. } => self.goal_state = Some(state.clone()),
            Statement::Threshold { threshold, .. } => self.threshold = *threshold,
            Statement::Conflicts { with, .. } => self.conflicts.push(with.clone()),
            Statement::RemoveConflict { with, .. } => {
                let Some(place) = self.conflicts.iter().position(|known| known.name == with.name) else {
                    let message = format!("rm `{}` was not said to conflict with rm `{with}`", self.name);
                    let known = self.conflicts.iter().map(|known| known.name.as_str());
                    return Err(Problem::new(with.at, message).near(&with.name, known));
                };
                self.conflicts.remove(place);
            }
            Statement::RemoveGoalState { .. } => self.goal_state = None,
            Statement::RemoveGoalSelection { .. } => self.selection = None,
            Statement::ReportsToTop { .. }
            | Statement::ReportsToRm { .. }
            | Statement::ReportsToSubroutine { .. }
            | Statement::RemoveRm { .. } => unreachable!("taken by the program"),
        }
        Ok(())
    }
}

fn twice(name: &Stated, role: &str, before: Position) -> Problem {
    Problem::new(
        name.at,
        format!("`{name}` is {role} already, at line {}", before.line),
    )
}

fn set(place: &mut Option<Stated>, name: &Stated, role: &str) -> Result<(), Problem> {
    match place {
        Some(before) => Err(twice(before, role, before.at)).map_err(|problem: Problem| Problem {
            line: name.at.line,
            column: name.at.column,
            ..problem
        }),
        None => {
            *place = Some(name.clone());
            Ok(())
        }
    }
}

/// The RM a statement is about.
fn subject(statement: &Statement) -> &Stated {
    match statement {
        Statement::AddStimulus { rm, .. }
        | Statement::ReportsToTop { rm }
        | Statement::ReportsToRm { rm, .. }
        | Statement::ReportsToSubroutine { rm, .. }
        | Statement::McuReports { rm, .. }
        | Statement::GoesToSubroutine { rm, .. }
        | Statement::SelectsGoal { rm, .. }
        | Statement::KeepsGoal { rm, .. }
        | Statement::GoalState { rm, .. }
        | Statement::Threshold { rm, .. }
        | Statement::Conflicts { rm, .. }
        | Statement::RemoveStimulus { rm, .. }
        | Statement::RemoveRm { rm }
        | Statement::RemoveConflict { rm, .. }
        | Statement::RemoveGoalState { rm }
        | Statement::RemoveGoalSelection { rm } => rm,
    }
}
