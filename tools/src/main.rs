//! `subsumectl`: looks at a running creature, stops it, checks creature files.

mod check;
mod compete;
mod doctor;
mod example;
mod export;
mod live;
mod manual;
mod modules;
mod new;
mod paint;
mod picture;
mod prefixes;
mod record;
mod reference;
mod replay;
mod test;
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
    subsumectl check mine.toml            every error of a creature file\n  \
    subsumectl test scenarios/            what must come of a creature, on the virtual clock\n  \
    subsumectl prefixes allen.toml --layers wander.toml --scenarios scenarios/\n  \
    subsumectl new creature mine          a creature to start from\n  \
    subsumectl graph mine.toml -o x.svg   a picture of it\n  \
    subsumectl compete allen --rows 01    how well levels 0 and 1 do, over 20 simulated hours\n\n\
    Status: 0 done; 1 not done (no daemon, refused, an expectation not met); 2 bad input."
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
    /// Writes a recording as other tools want it
    #[command(after_help = "Examples:\n  \
        subsumectl export run.mcap -o run-ros2.mcap    for ros2 bag, RViz, PlotJuggler, rosbags\n\n\
        Foxglove and the mcap packages open a recording as it is.\n\
        Status: 0 written; 2 not a recording, or the new file is there already.")]
    Export {
        /// The recording
        file: PathBuf,
        /// The file to write; one that is there is left alone
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        /// For whom
        #[arg(long, value_enum, default_value = "ros2")]
        profile: export::Profile,
    },
    /// Emergency stop; holds until reset
    Halt,
    /// Ends an emergency stop
    Reset,
    /// Checks creature files and manifests, and shows every error with its place
    Check {
        /// Creature files, and manifests of layers beside the file of their creature
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Checks the files as manifests of layers that join this creature; again, with a manifest, for a layer that
        /// has joined it before them
        #[arg(long = "in", value_name = "CREATURE.toml")]
        hosts: Vec<PathBuf>,
        /// Takes every file for a manifest
        #[arg(long)]
        manifest: bool,
        /// When to use colours
        #[arg(long, value_enum, default_value_t, value_name = "WHEN")]
        color: paint::Color,
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
    /// Writes the manual pages of subsumectl, subsumed and subsumed-body into a folder
    #[command(after_help = "Example: subsumectl man target/man && man -l target/man/subsumectl.1")]
    Man {
        /// The folder; made if it is not there
        folder: PathBuf,
    },
    /// Writes the reference of creature files, modules and commands into a folder, as Markdown
    #[command(after_help = "Example: subsumectl reference target/reference")]
    Reference {
        /// The folder; made if it is not there
        folder: PathBuf,
    },
    /// Prints the JSON Schema of creature files, for editors
    Schema,
    /// Writes something to start from: a creature, a layer in Rust, the layout of an office
    New {
        #[command(subcommand)]
        what: new::New,
    },
    /// Measures a creature level by level over many simulated hours, and prints the table
    Compete(compete::Asked),
    /// Truckin': games, the whole grid, evolution of trucks
    Truckin(truckin::command::TruckinArgs),
    /// ADROIT: check, draw, run and change programs of releasing mechanisms
    Adroit(adroit::command::AdroitArgs),
    /// Measures wake-ups, steps, period errors and ages under a load, alone or against cyclictest
    Latency(latency::command::LatencyArgs),
    /// What a beat costs as a creature grows: time, share of a processor, memory
    Scale(latency::scale::ScaleArgs),
    /// Whether this host can keep a period, and what to change where it can't
    Doctor(doctor::DoctorArgs),
    /// Draws a creature: layers stacked, wires, taps with their time constants; what is wrong in red
    Graph {
        /// The creature file, and manifests of layers that join it
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// More manifests of layers that join it
        #[arg(long, num_args = 1.., value_name = "MANIFEST")]
        layers: Vec<PathBuf>,
        /// Graphviz text instead of SVG
        #[arg(long)]
        dot: bool,
        /// Where to write; the terminal if not given
        #[arg(short, long, value_name = "OUT")]
        output: Option<PathBuf>,
    },
    /// Runs scenario files on the virtual clock
    Test {
        /// Scenario files, and folders of them
        #[arg(required = true, value_name = "FILE-or-FOLDER")]
        paths: Vec<PathBuf>,
        /// Only scenarios with this in their path or title
        #[arg(long, value_name = "TEXT")]
        filter: Option<String>,
        /// Steps the modules of a layer in another order each beat, by this seed
        #[arg(long, value_name = "SEED")]
        shuffle: Option<u64>,
        /// Writes a report for continuous integration as well
        #[arg(long, value_name = "FILE")]
        junit: Option<PathBuf>,
    },
    /// Tries every prefix of a creature's stack: alone, and while the layers above come and go
    Prefixes {
        /// The creature file
        #[arg(value_name = "CREATURE")]
        file: PathBuf,
        /// Manifests of layers that join it
        #[arg(long, num_args = 1.., value_name = "MANIFEST")]
        layers: Vec<PathBuf>,
        /// Scenario files, and folders of them
        #[arg(long, num_args = 1.., required = true, value_name = "FILE-or-FOLDER")]
        scenarios: Vec<PathBuf>,
        /// How often each competence is tried with layers above, each time with other moments
        #[arg(long, default_value_t = 5, value_name = "N")]
        seeds: u64,
    },
    /// Lists the kinds of module, or explains one
    Modules {
        /// A kind of module, such as threshold, or a group, such as allen
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
/// Counts what real-time threads allocate where this program has some (`latency`).
#[global_allocator]
static ALLOCATOR: daemon::alloc::Counting = daemon::alloc::Counting;

fn main() -> ExitCode {
    if let Some(status) = latency::workers::dispatch() {
        return status;
    }
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
        Command::Reference { folder } => reference::write(&folder),
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
        Command::Export {
            file,
            output,
            profile,
        } => return export::export(&file, &output, profile, json),
        Command::Events => live::events(creature, json),
        Command::Halt => live::order(
            creature,
            json,
            Request::Halt,
            "halted; `subsumectl reset` ends it",
        ),
        Command::Reset => live::order(creature, json, Request::Reset, "reset"),
        Command::Check {
            files,
            hosts,
            manifest,
            color,
        } => {
            return check::check(&check::Wanted {
                files: &files,
                hosts: &hosts,
                manifests: manifest,
                color,
                json,
            });
        }
        Command::Schema => return check::schema(),
        Command::New { what } => return new::new(&what, json),
        Command::Compete(asked) => return compete::compete(&asked, json),
        Command::Truckin(args) => return truckin::command::command(args),
        Command::Adroit(args) => return adroit::command::command(args),
        Command::Latency(args) => return latency::command::command(&args, json),
        Command::Scale(args) => return latency::scale::command(&args, json),
        Command::Doctor(args) => return doctor::doctor(&args, json),
        Command::Graph {
            mut files,
            layers,
            dot,
            output,
        } => {
            files.extend(layers);
            return picture::draw(&files, dot, output.as_deref(), json);
        }
        Command::Test {
            paths,
            filter,
            shuffle,
            junit,
        } => {
            return test::test(&test::Wanted {
                paths: &paths,
                filter: filter.as_deref(),
                shuffle,
                junit: junit.as_deref(),
                json,
            });
        }
        Command::Modules { name } => return modules::modules(name.as_deref(), json),
        Command::Prefixes {
            file,
            layers,
            scenarios,
            seeds,
        } => return prefixes::prefixes(&file, &layers, &scenarios, seeds, json),
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
