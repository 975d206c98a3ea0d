//! Level 2 of Allen as a hierarchy of releasing mechanisms: a layer process that runs a program.

use std::path::PathBuf;
use std::process::ExitCode;

use adroit::drives;
use adroit::language::Running;

const HELP: &str = "\
Runs a program of releasing mechanisms as level 2 of Allen.

Usage: allen-drives [--program FILE.adroit] [--commands SOCKET] [OPTIONS]

 --program FILE     the program; the built-in one explores, rests and seeks open space
 --commands SOCKET  takes commands there: subsumectl adroit apply|list|undo|save --socket SOCKET

Options: those of every layer process: --creature NAME, --once, --wait.
`subsumectl adroit check --robot drives FILE.adroit` checks a program without running it.

Status: 0 after a signal, 1 when refused or the daemon is gone, 2 for bad input.";

/// What is left of the arguments when the program and the socket are taken.
struct Asked {
    program: Option<PathBuf>,
    socket: Option<PathBuf>,
    others: Vec<String>,
}

impl Asked {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Asked, String> {
        let mut asked = Asked {
            program: None,
            socket: None,
            others: Vec::new(),
        };
        while let Some(argument) = arguments.next() {
            let place = match argument.as_str() {
                "--program" => &mut asked.program,
                "--commands" => &mut asked.socket,
                _ => {
                    asked.others.push(argument);
                    continue;
                }
            };
            let path = arguments.next().ok_or(format!("{argument} needs a path"))?;
            *place = Some(path.into());
        }
        Ok(asked)
    }

    /// The program, checked.
    fn load(&self) -> Result<Running, String> {
        let (name, text) = match &self.program {
            None => ("drives.adroit".to_owned(), drives::PROGRAM.to_owned()),
            Some(path) => {
                let name = path.display().to_string();
                let text = std::fs::read_to_string(path)
                    .map_err(|error| format!("{name}: {error}; expected a program"))?;
                (name, text)
            }
        };
        Running::load(&text, drives::vocabulary()).map_err(|problems| {
            let lines: Vec<String> = problems.0.iter().map(|p| format!("{name}:{p}")).collect();
            lines.join("\n")
        })
    }
}

fn main() -> ExitCode {
    if std::env::args().any(|a| a == "--help" || a == "-h") {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    let loaded =
        Asked::read(std::env::args().skip(1)).and_then(|asked| asked.load().map(|running| (asked, running)));
    let (asked, running) = match loaded {
        Ok(loaded) => loaded,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    let _served = match mechanisms::desk::open(running, asked.socket.as_deref()) {
        Ok(served) => served,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::FAILURE;
        }
    };
    afsm::process::run_with(
        mechanisms::drives_manifest(),
        mechanisms::kinds(),
        asked.others.into_iter(),
    )
}
