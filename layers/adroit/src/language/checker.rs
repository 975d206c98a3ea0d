//! Everything a program must be before it may run: known names, one tree, bounds, something to fall back on.

use super::problem::{Problem, Problems};
use super::program::{Declared, Program, Superordinate};
use super::statement::{Stated, Statement};
use super::vocabulary::{ALWAYS, Vocabulary};
use crate::hierarchy::{DEPTH_MAX, INPUTS_MAX, MECHANISMS_MAX, WIDTH_MAX};

/// Checks a program against the primitives of a body and the bounds of a hierarchy.
///
/// # Errors
/// Everything that is wrong, at once.
pub(crate) fn check(program: &Program, vocabulary: &Vocabulary) -> Result<(), Problems> {
    let mut checker = Checker {
        program,
        vocabulary,
        problems: Vec::new(),
    };
    for rm in &program.rms {
        checker.primitives(rm);
        checker.place(rm);
        checker.control(rm);
        checker.conflicts(rm);
    }
    checker.bounds();
    if checker.problems.is_empty() {
        checker.depth();
    }
    if checker.problems.is_empty() {
        checker.always_something();
    }
    Problems::none_of(checker.problems)
}

/// Names in single sentences that the body does not have: what can be said of a program that cannot be read whole.
pub(crate) fn unknown_primitives(statements: &[Statement], vocabulary: &Vocabulary) -> Vec<Problem> {
    let mut checker = Checker {
        program: &Program::default(),
        vocabulary,
        problems: Vec::new(),
    };
    for statement in statements {
        checker.primitive(statement);
    }
    checker.problems
}

struct Checker<'a> {
    program: &'a Program,
    vocabulary: &'a Vocabulary,
    problems: Vec<Problem>,
}

impl<'a> Checker<'a> {
    fn problem(&mut self, at: &Stated, message: String) {
        self.problems.push(Problem::new(at.at, message));
    }

    fn known<'b>(&mut self, name: &Stated, what: &str, names: impl Iterator<Item = &'b str> + Clone) {
        if !names.clone().any(|known| known == name.name) {
            let message = format!("unknown {what} `{name}`; expected one that the body has");
            self.problems
                .push(Problem::new(name.at, message).near(&name.name, names));
        }
    }

    fn primitive(&mut self, statement: &Statement) {
        let vocabulary = self.vocabulary;
        let (name, what, names): (_, _, Vec<&str>) = match statement {
            Statement::AddStimulus { stimulus, .. } => (stimulus, "stimulus", vocabulary.stimuli().collect()),
            Statement::SelectsGoal { criterion, .. } | Statement::KeepsGoal { criterion, .. } => {
                (criterion, "goal criterion", vocabulary.criteria().collect())
            }
            Statement::GoalState { state, .. } => (state, "goal state", vocabulary.states().collect()),
            Statement::McuReports { mcu, .. } => (mcu, "mcu", vocabulary.mcus().collect()),
            _ => return,
        };
        self.known(name, what, names.into_iter());
    }

    fn primitives(&mut self, rm: &Declared) {
        let vocabulary = self.vocabulary;
        for (stimulus, _) in &rm.inputs {
            let names: Vec<&str> = vocabulary.stimuli().collect();
            self.known(stimulus, "stimulus", names.into_iter());
        }
        if let Some((criterion, _)) = &rm.selection {
            let names: Vec<&str> = vocabulary.criteria().collect();
            self.known(criterion, "goal criterion", names.into_iter());
        }
        if let Some(state) = &rm.goal_state {
            let names: Vec<&str> = vocabulary.states().collect();
            self.known(state, "goal state", names.into_iter());
        }
        if let Some(mcu) = &rm.mcu {
            let names: Vec<&str> = vocabulary.mcus().collect();
            self.known(mcu, "mcu", names.into_iter());
        }
        if rm.inputs.len() > INPUTS_MAX {
            self.problem(
                &rm.name,
                format!("rm `{}` has more than {INPUTS_MAX} inputs", rm.name),
            );
        }
    }

    fn place(&mut self, rm: &Declared) {
        let program = self.program;
        let names = program.rms.iter().map(|known| known.name.name.as_str());
        match &rm.superordinate {
            Superordinate::Rm(up) if program.find(&up.name).is_none() => {
                let message = format!("there is no rm `{up}`; expected an rm that reports to something");
                self.problems
                    .push(Problem::new(up.at, message).near(&up.name, names));
            }
            Superordinate::Subroutine(own) => {
                let called = program.rms.iter().filter_map(|known| known.subroutine.as_ref());
                if !called.clone().any(|called| called.name == own.name) {
                    let message = format!("the goal parameters of no rm go to subroutine `{own}`");
                    let names = called.map(|called| called.name.as_str());
                    self.problems
                        .push(Problem::new(own.at, message).near(&own.name, names));
                }
            }
            _ => {}
        }
        if let Some(called) = &rm.subroutine
            && members(program, &Above::Subroutine(&called.name))
                .next()
                .is_none()
        {
            let names = program.rms.iter().filter_map(|known| match &known.superordinate {
                Superordinate::Subroutine(name) => Some(name.name.as_str()),
                _ => None,
            });
            let message = format!("no rm reports to subroutine `{called}`");
            self.problems
                .push(Problem::new(called.at, message).near(&called.name, names));
        }
    }

    fn control(&mut self, rm: &Declared) {
        let branches = members(self.program, &Above::Rm(&rm.name.name)).next();
        let controls = usize::from(branches.is_some())
            + usize::from(rm.mcu.is_some())
            + usize::from(rm.subroutine.is_some());
        if controls == 0 {
            let message = format!(
                "rm `{}` controls nothing; expected rms or an mcu that report to it, or a subroutine its goal \
                 parameters go to",
                rm.name
            );
            self.problem(&rm.name, message);
        }
        if controls > 1 {
            let message = format!(
                "rm `{}` controls more than one of: subordinate rms, an mcu, a subroutine",
                rm.name
            );
            self.problem(&rm.name, message);
        }
    }

    fn conflicts(&mut self, rm: &Declared) {
        for other in &rm.conflicts {
            match self.program.find(&other.name) {
                None => {
                    let names = self.program.rms.iter().map(|known| known.name.name.as_str());
                    let message = format!("there is no rm `{other}` to conflict with");
                    self.problems
                        .push(Problem::new(other.at, message).near(&other.name, names));
                }
                Some(known) if known.name.name == rm.name.name => {
                    self.problem(other, format!("rm `{other}` cannot conflict with itself"));
                }
                Some(known) if !same_level(known, rm) => {
                    let message = format!("rm `{other}` and rm `{}` are not of the same level", rm.name);
                    self.problem(other, message);
                }
                Some(_) => {}
            }
        }
    }

    fn bounds(&mut self) {
        let program = self.program;
        if program.rms.len() > MECHANISMS_MAX {
            let message = format!("a program has at most {MECHANISMS_MAX} rms");
            self.problem(&program.rms[MECHANISMS_MAX].name, message);
        }
        for rm in &program.rms {
            let mut siblings = program.rms.iter().filter(|other| same_level(other, rm));
            if let Some(beyond) = siblings.nth(WIDTH_MAX).filter(|beyond| beyond.name == rm.name) {
                self.problem(&beyond.name, format!("a level has at most {WIDTH_MAX} rms"));
            }
        }
    }

    /// Follows every way down; a circle is longer than any bound.
    fn depth(&mut self) {
        for rm in &self.program.rms {
            if rm.superordinate == Superordinate::Top {
                self.descend(rm, 1);
            } else if !self.reaches_root(rm) {
                let message = format!("rm `{}` reports in a circle that never reaches the top", rm.name);
                self.problem(&rm.name, message);
            }
        }
    }

    fn reaches_root(&self, rm: &Declared) -> bool {
        let mut here = rm;
        for _ in 0..self.program.rms.len() {
            match &here.superordinate {
                Superordinate::Top | Superordinate::Subroutine(_) => return true,
                Superordinate::Rm(up) => match self.program.find(&up.name) {
                    Some(above) => here = above,
                    None => return true,
                },
            }
        }
        false
    }

    fn descend(&mut self, rm: &'a Declared, depth: usize) {
        if depth > DEPTH_MAX {
            let message = format!(
                "below rm `{}` there are more than {DEPTH_MAX} levels, or a circle",
                rm.name
            );
            self.problem(&rm.name, message);
            return;
        }
        let program = self.program;
        let below = match &rm.subroutine {
            Some(called) => Above::Subroutine(&called.name),
            None => Above::Rm(&rm.name.name),
        };
        for member in members(program, &below) {
            if self.problems.is_empty() {
                self.descend(member, depth + 1);
            }
        }
    }

    /// The top level has to find a choice whatever the body senses.
    fn always_something(&mut self) {
        let program = self.program;
        if !members(program, &Above::Top).any(|rm| certain(program, rm)) {
            let message = "the top level may find nothing to choose; expected an rm that reports to top, is excited \
                           by `always` above its threshold, and acts without looking for a goal";
            self.problems.push(Problem {
                line: 1,
                column: 1,
                message: message.to_owned(),
                nearest: None,
            });
        }
    }
}

/// Whether an RM can be chosen and act in every state of the world.
fn certain(program: &Program, rm: &Declared) -> bool {
    let least: f64 = rm
        .inputs
        .iter()
        .map(|(name, by)| if name.name == ALWAYS { *by } else { by.min(0.0) })
        .sum();
    let below = match &rm.subroutine {
        Some(called) => Above::Subroutine(&called.name),
        None => Above::Rm(&rm.name.name),
    };
    let acts = rm.mcu.is_some() || members(program, &below).any(|member| certain(program, member));
    least > rm.threshold && rm.selection.is_none() && rm.goal_state.is_none() && acts
}

/// What stands above a level.
pub(crate) enum Above<'a> {
    Top,
    Rm(&'a str),
    Subroutine(&'a str),
}

/// The RMs of one level, in the order in which they are introduced.
pub(crate) fn members<'a>(
    program: &'a Program,
    above: &Above<'a>,
) -> impl Iterator<Item = &'a Declared> + use<'a> {
    let above = match *above {
        Above::Top => (0, ""),
        Above::Rm(name) => (1, name),
        Above::Subroutine(name) => (2, name),
    };
    program
        .rms
        .iter()
        .filter(move |rm| key(&rm.superordinate) == above)
}

fn same_level(one: &Declared, other: &Declared) -> bool {
    key(&one.superordinate) == key(&other.superordinate)
}

fn key(superordinate: &Superordinate) -> (u8, &str) {
    match superordinate {
        Superordinate::Top => (0, ""),
        Superordinate::Rm(name) => (1, &name.name),
        Superordinate::Subroutine(name) => (2, &name.name),
    }
}
