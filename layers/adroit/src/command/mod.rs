//! The `adroit` commands, as a library so that another tool can offer them under its own name.

mod figures;
mod run;
mod teach;

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};

use crate::draw::svg;
use crate::hierarchy::Hierarchy;
use crate::language::{self, Problems, Vocabulary, format};
use crate::{drives, live, nest};

/// Arguments of `adroit`.
#[derive(Args, Clone, Debug)]
pub struct AdroitArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Clone, Debug)]
enum What {
    /// Check a program and report everything that is wrong with it
    Check(Program),
    /// Print a program in its standard form
    Format {
        #[command(flatten)]
        file: File,
        /// Write the file instead of printing it
        #[arg(long)]
        write: bool,
    },
    /// Draw the hierarchy of a program as SVG
    Graph(Program),
    /// Run a program in a seeded world
    Run(run::RunArgs),
    /// Apply a command to a running hierarchy
    Apply {
        #[command(flatten)]
        at: live::Address,
        /// One or more statements of the language
        command: String,
    },
    /// List the commands applied to a running hierarchy
    List(live::Address),
    /// Take back the latest command applied to a running hierarchy
    Undo(live::Address),
    /// Print the program of a running hierarchy with all that was applied to it
    Save(live::Address),
    /// Teach it a cue that means nothing yet, and watch it learn
    Teach(teach::TeachArgs),
    /// Run many seeded worlds and print figures
    Figures(figures::FiguresArgs),
}

/// The program to work on.
#[derive(Args, Clone, Debug)]
struct File {
    /// A program; `-` reads from standard input, nothing takes the one the robot comes with
    file: Option<PathBuf>,
}

/// A program, and the robot whose primitives it names.
#[derive(Args, Clone, Debug)]
struct Program {
    #[command(flatten)]
    file: File,
    /// Whose stimuli, goal criteria, goal states and motor control units it may name
    #[arg(long, value_enum, default_value = "nest")]
    robot: Robot,
}

/// The robots that programs are written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Robot {
    /// The nest builder of the source.
    Nest,
    /// Allen, with a hierarchy as level 2.
    Drives,
}

impl Robot {
    fn vocabulary(self) -> Vocabulary {
        match self {
            Robot::Nest => nest::vocabulary(),
            Robot::Drives => drives::vocabulary(),
        }
    }
}

impl Program {
    fn load(&self) -> Result<Hierarchy, Trouble> {
        let (text, name) = match (&self.file.file, self.robot) {
            (None, Robot::Drives) => (drives::PROGRAM.to_owned(), "drives.adroit".to_owned()),
            _ => self.file.read().map_err(|error| self.file.unreadable(&error))?,
        };
        language::load(&text, &self.robot.vocabulary())
            .map_err(|problems| Trouble::Input(placed(&name, &problems)))
    }
}

impl File {
    /// The text, and the name to put before its problems.
    fn read(&self) -> io::Result<(String, String)> {
        match &self.file {
            None => Ok((nest::PROGRAM.to_owned(), "nest.adroit".to_owned())),
            Some(path) if path == Path::new("-") => {
                let mut text = String::new();
                io::stdin().read_to_string(&mut text)?;
                Ok((text, "standard input".to_owned()))
            }
            Some(path) => Ok((fs::read_to_string(path)?, path.display().to_string())),
        }
    }

    fn unreadable(&self, error: &io::Error) -> Trouble {
        match &self.file {
            Some(path) => Trouble::Input(format!("{}: {error}; expected a program", path.display())),
            None => Trouble::NotDone(error.to_string()),
        }
    }
}

/// What went wrong, and the exit status that says so.
enum Trouble {
    /// Bad input: status 2.
    Input(String),
    /// Not done: status 1.
    NotDone(String),
}

impl From<String> for Trouble {
    fn from(problem: String) -> Trouble {
        Trouble::NotDone(problem)
    }
}

/// Every problem on a line of its own behind the name of its file.
fn placed(name: &str, problems: &Problems) -> String {
    let lines: Vec<String> = problems
        .0
        .iter()
        .map(|problem| format!("{name}:{problem}"))
        .collect();
    lines.join("\n")
}

/// Carries out a command; results go to standard output, what is wrong to standard error.
/// Status: 0 done, 1 not done, 2 bad input.
#[must_use]
pub fn command(args: AdroitArgs) -> ExitCode {
    let result = match args.what {
        What::Check(program) => program.load().map(|hierarchy| {
            println!(
                "{} RMs at {} levels; no problems",
                hierarchy.mechanisms().len(),
                hierarchy.levels().len()
            );
        }),
        What::Format { file, write } => formatted(&file, write),
        What::Graph(program) => program
            .load()
            .map(|hierarchy| print!("{}", svg(&hierarchy, &program.robot.vocabulary()))),
        What::Run(args) => run::run(&args),
        What::Apply { at, command } => at.ask(&live::Request::Apply(command)).map_err(Trouble::from),
        What::List(at) => at.ask(&live::Request::List).map_err(Trouble::from),
        What::Undo(at) => at.ask(&live::Request::Undo).map_err(Trouble::from),
        What::Save(at) => at.ask(&live::Request::Save).map_err(Trouble::from),
        What::Teach(args) => teach::teach(&args).map_err(Trouble::from),
        What::Figures(args) => figures::figures(&args).map_err(Trouble::from),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Trouble::Input(problem)) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
        Err(Trouble::NotDone(problem)) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn formatted(file: &File, write: bool) -> Result<(), Trouble> {
    let (text, name) = file.read().map_err(|error| file.unreadable(&error))?;
    let formatted = format(&text).map_err(|problems| Trouble::Input(placed(&name, &problems)))?;
    match &file.file {
        Some(path) if write && path != Path::new("-") => {
            fs::write(path, formatted).map_err(|error| file.unreadable(&error))
        }
        _ => {
            print!("{formatted}");
            Ok(())
        }
    }
}
