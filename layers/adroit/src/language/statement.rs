//! The statements of the language, each written back exactly as the formatter wants it.

use std::fmt;

use super::problem::Position;

/// A name in a program, and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stated {
    /// The name.
    pub name: String,
    pub(crate) at: Position,
}

impl fmt::Display for Stated {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.name)
    }
}

/// One statement of the language, with or without its place in a text.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    missing_docs,
    reason = "each statement is its own sentence; see docs/grammar.md"
)]
pub enum Statement {
    AddStimulus {
        stimulus: Stated,
        rm: Stated,
        magnitude: f64,
    },
    ReportsToTop {
        rm: Stated,
    },
    ReportsToRm {
        rm: Stated,
        superordinate: Stated,
    },
    ReportsToSubroutine {
        rm: Stated,
        subroutine: Stated,
    },
    McuReports {
        mcu: Stated,
        rm: Stated,
    },
    GoesToSubroutine {
        rm: Stated,
        subroutine: Stated,
    },
    SelectsGoal {
        rm: Stated,
        criterion: Stated,
    },
    KeepsGoal {
        rm: Stated,
        criterion: Stated,
    },
    GoalState {
        rm: Stated,
        state: Stated,
    },
    Threshold {
        rm: Stated,
        threshold: f64,
    },
    Conflicts {
        rm: Stated,
        with: Stated,
    },
    RemoveStimulus {
        stimulus: Stated,
        rm: Stated,
    },
    RemoveRm {
        rm: Stated,
    },
    RemoveConflict {
        rm: Stated,
        with: Stated,
    },
    RemoveGoalState {
        rm: Stated,
    },
    RemoveGoalSelection {
        rm: Stated,
    },
}

impl fmt::Display for Statement {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AddStimulus {
                stimulus,
                rm,
                magnitude,
            } => {
                write!(
                    out,
                    "add stimulus {stimulus} to rm {rm} with magnitude {magnitude}."
                )
            }
            Self::ReportsToTop { rm } => write!(out, "rm {rm} reports to top."),
            Self::ReportsToRm { rm, superordinate } => write!(out, "rm {rm} reports to rm {superordinate}."),
            Self::ReportsToSubroutine { rm, subroutine } => {
                write!(out, "rm {rm} reports to subroutine {subroutine}.")
            }
            Self::McuReports { mcu, rm } => write!(out, "mcu {mcu} reports to rm {rm}."),
            Self::GoesToSubroutine { rm, subroutine } => {
                write!(out, "goal parameters of rm {rm} go to subroutine {subroutine}.")
            }
            Self::SelectsGoal { rm, criterion } => write!(out, "rm {rm} selects goal {criterion}."),
            Self::KeepsGoal { rm, criterion } => write!(out, "rm {rm} keeps goal {criterion}."),
            Self::GoalState { rm, state } => write!(out, "goal state of rm {rm} is {state}."),
            Self::Threshold { rm, threshold } => write!(out, "threshold of rm {rm} is {threshold}."),
            Self::Conflicts { rm, with } => write!(out, "rm {rm} conflicts with rm {with}."),
            Self::RemoveStimulus { stimulus, rm } => write!(out, "remove stimulus {stimulus} from rm {rm}."),
            Self::RemoveRm { rm } => write!(out, "remove rm {rm}."),
            Self::RemoveConflict { rm, with } => write!(out, "remove conflict of rm {rm} with rm {with}."),
            Self::RemoveGoalState { rm } => write!(out, "remove goal state of rm {rm}."),
            Self::RemoveGoalSelection { rm } => write!(out, "remove goal selection of rm {rm}."),
        }
    }
}
