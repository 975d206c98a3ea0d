//! Words to statements; after an error it goes on behind the next full stop, to find all errors at once.

use super::lexer::{self, Kind, Token};
use super::problem::{Problem, Problems};
use super::statement::{Stated, Statement};

/// First words of the statements.
const OPENINGS: [&str; 6] = ["add", "remove", "rm", "mcu", "goal", "threshold"];

/// Reads all statements of a text.
///
/// # Errors
/// Every place where the text is not of the language.
pub(crate) fn parse(text: &str) -> Result<Vec<Statement>, Problems> {
    let (statements, problems) = parse_what_can_be(text);
    Problems::none_of(problems)?;
    Ok(statements)
}

/// Reads the statements that are of the language, and tells what is not.
pub(crate) fn parse_what_can_be(text: &str) -> (Vec<Statement>, Vec<Problem>) {
    let (tokens, mut problems) = lexer::split(text);
    let tokens: Vec<Token> = tokens
        .into_iter()
        .filter(|token| !matches!(token.kind, Kind::Comment(_)))
        .collect();
    let mut parser = Parser {
        tokens: &tokens,
        next: 0,
    };
    let mut statements = Vec::new();
    while parser.peek().kind != Kind::End {
        match parser.statement() {
            Ok(statement) => statements.push(statement),
            Err(problem) => {
                problems.push(problem);
                parser.skip_statement();
            }
        }
    }
    (statements, problems)
}

pub(crate) struct Parser<'a> {
    tokens: &'a [Token],
    next: usize,
}

impl<'a> Parser<'a> {
    pub(crate) fn over(tokens: &'a [Token]) -> Self {
        Self { tokens, next: 0 }
    }

    fn peek(&self) -> &'a Token {
        &self.tokens[self.next]
    }

    fn take(&mut self) -> &'a Token {
        let token = self.peek();
        if token.kind != Kind::End {
            self.next += 1;
        }
        token
    }

    fn skip_statement(&mut self) {
        loop {
            match self.take().kind {
                Kind::Stop | Kind::End => return,
                _ => {}
            }
        }
    }

    /// Takes one of some words of the language.
    fn one_of(&mut self, words: &[&'static str]) -> Result<&'static str, Problem> {
        let token = self.peek();
        let written = match &token.kind {
            Kind::Word(word) => word.as_str(),
            _ => "",
        };
        if let Some(&word) = words.iter().find(|&&word| word == written) {
            self.take();
            return Ok(word);
        }
        let expected: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
        let message = format!("expected {}, found {}", expected.join(" or "), token.described());
        Err(Problem::new(token.at, message).near(written, words.iter().copied()))
    }

    fn words(&mut self, words: &[&'static str]) -> Result<(), Problem> {
        words.iter().try_for_each(|word| self.one_of(&[word]).map(|_| ()))
    }

    fn name(&mut self, of: &str) -> Result<Stated, Problem> {
        let token = self.peek();
        let Kind::Word(word) = &token.kind else {
            return Err(Problem::new(
                token.at,
                format!("expected the name of {of}, found {}", token.described()),
            ));
        };
        self.take();
        Ok(Stated {
            name: word.clone(),
            at: token.at,
        })
    }

    fn rm(&mut self) -> Result<Stated, Problem> {
        self.one_of(&["rm"])?;
        self.name("an rm")
    }

    fn number(&mut self) -> Result<f64, Problem> {
        let token = self.peek();
        let Kind::Number(number) = token.kind else {
            return Err(Problem::new(
                token.at,
                format!("expected a number, found {}", token.described()),
            ));
        };
        self.take();
        Ok(number)
    }

    pub(crate) fn statement(&mut self) -> Result<Statement, Problem> {
        let statement = match self.one_of(&OPENINGS)? {
            "add" => self.add()?,
            "remove" => self.remove()?,
            "rm" => self.about_rm()?,
            "mcu" => {
                let mcu = self.name("an mcu")?;
                self.words(&["reports", "to"])?;
                Statement::McuReports { mcu, rm: self.rm()? }
            }
            "goal" => self.goal()?,
            _ => {
                self.words(&["of"])?;
                let rm = self.rm()?;
                self.words(&["is"])?;
                Statement::Threshold {
                    rm,
                    threshold: self.number()?,
                }
            }
        };
        let stop = self.peek();
        if stop.kind != Kind::Stop {
            let message = format!(
                "expected `.` at the end of the statement, found {}",
                stop.described()
            );
            return Err(Problem::new(stop.at, message));
        }
        self.take();
        Ok(statement)
    }

    fn add(&mut self) -> Result<Statement, Problem> {
        self.words(&["stimulus"])?;
        let stimulus = self.name("a stimulus")?;
        self.words(&["to"])?;
        let rm = self.rm()?;
        self.words(&["with", "magnitude"])?;
        Ok(Statement::AddStimulus {
            stimulus,
            rm,
            magnitude: self.number()?,
        })
    }

    fn remove(&mut self) -> Result<Statement, Problem> {
        match self.one_of(&["stimulus", "rm", "conflict", "goal"])? {
            "stimulus" => {
                let stimulus = self.name("a stimulus")?;
                self.words(&["from"])?;
                Ok(Statement::RemoveStimulus {
                    stimulus,
                    rm: self.rm()?,
                })
            }
            "rm" => Ok(Statement::RemoveRm {
                rm: self.name("an rm")?,
            }),
            "conflict" => {
                self.words(&["of"])?;
                let rm = self.rm()?;
                self.words(&["with"])?;
                Ok(Statement::RemoveConflict { rm, with: self.rm()? })
            }
            _ => {
                let what = self.one_of(&["state", "selection"])?;
                self.words(&["of"])?;
                let rm = self.rm()?;
                Ok(match what {
                    "state" => Statement::RemoveGoalState { rm },
                    _ => Statement::RemoveGoalSelection { rm },
                })
            }
        }
    }

    fn about_rm(&mut self) -> Result<Statement, Problem> {
        let rm = self.name("an rm")?;
        match self.one_of(&["reports", "selects", "keeps", "conflicts"])? {
            "reports" => {
                self.words(&["to"])?;
                Ok(match self.one_of(&["top", "rm", "subroutine"])? {
                    "top" => Statement::ReportsToTop { rm },
                    "rm" => Statement::ReportsToRm {
                        rm,
                        superordinate: self.name("an rm")?,
                    },
                    _ => Statement::ReportsToSubroutine {
                        rm,
                        subroutine: self.name("a subroutine")?,
                    },
                })
            }
            "selects" => {
                self.words(&["goal"])?;
                Ok(Statement::SelectsGoal {
                    rm,
                    criterion: self.name("a goal criterion")?,
                })
            }
            "keeps" => {
                self.words(&["goal"])?;
                Ok(Statement::KeepsGoal {
                    rm,
                    criterion: self.name("a goal criterion")?,
                })
            }
            _ => {
                self.words(&["with"])?;
                Ok(Statement::Conflicts { rm, with: self.rm()? })
            }
        }
    }

    fn goal(&mut self) -> Result<Statement, Problem> {
        match self.one_of(&["parameters", "state"])? {
            "parameters" => {
                self.words(&["of"])?;
                let rm = self.rm()?;
                self.words(&["go", "to", "subroutine"])?;
                Ok(Statement::GoesToSubroutine {
                    rm,
                    subroutine: self.name("a subroutine")?,
                })
            }
            _ => {
                self.words(&["of"])?;
                let rm = self.rm()?;
                self.words(&["is"])?;
                Ok(Statement::GoalState {
                    rm,
                    state: self.name("a goal state")?,
                })
            }
        }
    }
}
