//! `subsumectl`: looks at a running creature, stops it, checks creature files.

mod check;
mod live;
mod manual;
mod record;
mod replay;
mod top;
mod watch;
mod why;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use ipc::control::Request;

/// Looks at a running creature, stops it, checks creature files.
#[derive(Parser, Debug)]
#[command(
    name = "subsumectl",
    version,
    after_help = "Examples:\n  \
    subsumectl status                     what the creature does\n  \
    subsumectl top                        the same, live\n  \
    subsumectl watch turn.rate            messages of a wire as they come\n  \
    subsumectl why body.forward           what the wheels are told, and why\n  \
    subsumectl halt; subsumectl reset     emergency stop, and its end\n  \
    subsumectl --creature jerry status    another instance\n  \
    subsumectl check mine.toml            every error of a creature file\n\n\
    Status: 0 done; 1 not done (no daemon, refused); 2 bad input."
)]
struct Options {
    /// The running creature to speak to; allen if not given
    #[arg(long, global = true, value_name = "NAME")]
    creature: Option<String>,
    /// Machine-readable output
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Layers with beats, overruns and latencies; who is attached; halt state
    Status,
    /// The same on the whole terminal, live: layers, taps, wires, halt; keys to sort, filter, halt and reset
    #[command(
        after_help = "Examples:\n  subsumectl top\n  NO_COLOR=1 subsumectl --creature jerry top\n\n\
        Keys: q quit, s sort, / filter, f freeze, h halt, r reset, ? help"
    )]
    Top,
    /// Every wire with type, rate, age and newest value
    Wires,
    /// Messages of a wire as they come, until Ctrl-C
    Watch {
        /// The wire, named after its output port, such as sonar.map
        wire: String,
        /// Leave after this many messages
        #[arg(long, value_name = "N")]
        count: Option<u64>,
        /// Leave after this many seconds
        #[arg(long, value_name = "N")]
        seconds: Option<f64>,
    },
    /// What happened: layers that came and went, halts, overruns
    Events,
    /// The chain behind the newest message of a wire, back to the sensors
    #[command(after_help = "Examples:\n  \
        subsumectl why body.forward                       what the wheels are told, and why\n  \
        subsumectl why turn.heading --from f.mcap --at -2  two seconds before a recording's end")]
    Why {
        /// The wire, such as turn.heading, or an input of the body, such as body.forward
        wire: String,
        #[command(flatten)]
        when: When,
    },
    /// For every tapped port who holds it, and who gets it next
    #[command(after_help = "Examples:\n  subsumectl holders\n  subsumectl holders --from f.mcap --at 12.5")]
    Holders {
        #[command(flatten)]
        when: When,
    },
    /// Records all wires, taps, halts, overruns and the log into an MCAP file, until Ctrl-C
    #[command(after_help = "Examples:\n  \
        subsumectl record -o run.mcap --seconds 60     one minute from now\n  \
        subsumectl record -o halt.mcap --ring 60s      the last minute before the next halt\n  \
        subsumectl record -o now.mcap --past           what the flight recorder holds, at once\n\n\
        The daemon's flight recorder keeps the last minute of every halt by itself: see subsumed --help.")]
    Record {
        /// The file to write
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        /// Stop after this many seconds
        #[arg(long, value_name = "N")]
        seconds: Option<f64>,
        /// Keep only the newest stretch, such as 60s, and stop when the body halts
        #[arg(long, value_name = "SPAN", value_parser = ipc::clock::Span::parse)]
        ring: Option<ipc::clock::Span>,
        /// What the flight recorder holds already, and no more
        #[arg(long, conflicts_with_all = ["seconds", "ring"])]
        past: bool,
    },
    /// Runs a recording through the layers again and says where the outputs differ
    #[command(after_help = "Examples:\n  \
        subsumectl replay run.mcap                        none, for the build that recorded it\n  \
        subsumectl replay run.mcap --creature mine.toml   what another creature file would have done\n\n\
        Status: 0 no difference; 1 differences; 2 not a recording, or a bad creature file.")]
    Replay {
        /// The recording
        file: PathBuf,
    },
    /// Emergency stop; holds until reset
    Halt,
    /// Ends an emergency stop
    Reset,
    /// Checks creature files and shows every error with its place
    Check {
        /// Creature files
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// Prints completions for a shell
    #[command(after_help = "Examples:\n  \
        subsumectl completions bash > /usr/share/bash-completion/completions/subsumectl\n  \
        subsumectl completions zsh --program subsumed > _subsumed")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
        /// Whose command line
        #[arg(long, value_enum, default_value = "subsumectl")]
        program: manual::Program,
    },
    /// Writes the manual pages of subsumectl and subsumed into a folder
    #[command(after_help = "Example: subsumectl man target/man && man -l target/man/subsumectl.1")]
    Man {
        /// The folder; made if it is not there
        folder: PathBuf,
    },
    /// Truckin': games, the whole grid, evolution of trucks
    Truckin(truckin::command::TruckinArgs),
    /// ADROIT: check, draw, run and change programs of releasing mechanisms
    Adroit(adroit::command::AdroitArgs),
    /// Lists the kinds of module, or explains one
    Modules {
        /// A kind of module
        name: Option<String>,
    },
}

/// Where to look, and when.
#[derive(clap::Args, Debug)]
struct When {
    /// A recording instead of the running creature
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// The moment, in seconds since the creature began; negative counts back from the end
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    at: Option<f64>,
}

impl From<When> for why::When {
    fn from(when: When) -> why::When {
        why::When {
            from: when.from,
            at: when.at,
        }
    }
}

fn main() -> ExitCode {
    // A reader that leaves early, such as `head`, ends this program without a complaint.
    let gone = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let _ = signal_hook::flag::register_conditional_default(signal_hook::consts::SIGPIPE, gone);
    let options = Options::parse();
    let (creature, json) = (options.creature.as_deref().unwrap_or("allen"), options.json);
    let done = match options.command {
        Command::Status => live::status(creature, json),
        Command::Top => top::top(creature),
        Command::Completions { shell, program } => {
            manual::completions(shell, program);
            Ok(())
        }
        Command::Man { folder } => manual::pages(&folder),
        Command::Wires => live::wires(creature, json),
        Command::Watch { wire, count, seconds } => watch::watch(creature, &wire, json, count, seconds),
        Command::Why { wire, when } => why::why(creature, &wire, &when.into(), json),
        Command::Holders { when } => why::holders(creature, &when.into(), json),
        Command::Record {
            output,
            seconds,
            ring,
            past,
        } => {
            let seconds = if past { Some(0.0) } else { seconds };
            record::record(creature, &output, json, &record::Wanted { seconds, ring, past })
        }
        Command::Replay { file } => {
            return replay::replay(&file, options.creature.as_deref().map(Path::new), json);
        }
        Command::Events => live::events(creature, json),
        Command::Halt => live::order(
            creature,
            json,
            Request::Halt,
            "halted; `subsumectl reset` ends it",
        ),
        Command::Reset => live::order(creature, json, Request::Reset, "reset"),
        Command::Check { files } => return check::check(&files, json),
        Command::Truckin(args) => return truckin::command::command(args),
        Command::Adroit(args) => return adroit::command::command(args),
        Command::Modules { name } => return check::modules(name.as_deref(), json),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            if json {
                println!("{}", serde_json::json!({ "error": message }));
            }
            eprintln!("subsumectl: {message}");
            ExitCode::FAILURE
        }
    }
}
