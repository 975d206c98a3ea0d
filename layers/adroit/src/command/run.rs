//! `adroit run`: a seeded world in real time or as fast as it goes.

use std::io::{self, Write};
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::{File, Trouble, placed};
use crate::draw::svg;
use crate::live::Listener;
use crate::nest::{BEAT_S, Layout, Run, Scene, picture};

/// Beats between two pictures.
const PICTURE_BEATS: u64 = 2;

#[derive(Args, Clone, Debug)]
pub(super) struct RunArgs {
    #[command(flatten)]
    file: File,
    /// The demonstration to watch
    #[arg(long, default_value = "seeded", value_parser = PossibleValuesParser::new(Scene::NAMES))]
    scene: String,
    /// Seed of the world
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// End after this many seconds; without it, when the nest is complete
    #[arg(long)]
    seconds: Option<f64>,
    /// Beat by beat on the wall clock instead of as fast as it goes
    #[arg(long)]
    real_time: bool,
    /// Print every picture as a line of JSON instead of what the robot does
    #[arg(long)]
    json: bool,
    /// Use the sequential strategy alone
    #[arg(long)]
    no_planning: bool,
    /// Take commands to the running hierarchy on this socket
    #[arg(long)]
    socket: Option<PathBuf>,
    /// Draw the hierarchy as it stands at the end to this file
    #[arg(long)]
    graph: Option<PathBuf>,
}

pub(super) fn run(args: &RunArgs) -> Result<(), Trouble> {
    let (text, name) = args.file.read().map_err(|error| args.file.unreadable(&error))?;
    let scene = Scene::named(&args.scene).expect("the parser knows the scenes");
    let mut world = scene.world(args.seed, Layout::default());
    world.planning &= !args.no_planning;
    let mut run =
        Run::with_program(world, &text).map_err(|problems| Trouble::Input(placed(&name, &problems)))?;
    let listener = args.socket.as_deref().map(Listener::open).transpose()?;
    let limit_s = args.seconds.unwrap_or(crate::figures::LIMIT_S);
    let mut out = io::stdout().lock();
    let (mut beats, mut path_before) = (0_u64, String::new());
    while run.world.now_s < limit_s && (args.seconds.is_some() || !run.world.nest_complete()) {
        if let Some(listener) = &listener {
            listener.serve(&mut run.control, |_| {});
        }
        let evaluated = run.beat();
        let written = if args.json && beats.is_multiple_of(PICTURE_BEATS) {
            let line = serde_json::to_string(&picture(&run)).map_err(|error| error.to_string())?;
            writeln!(out, "{line}")
        } else if evaluated && !args.json {
            tell(&mut out, &run, &mut path_before)
        } else {
            Ok(())
        };
        match written {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
            other => other.map_err(|error| error.to_string())?,
        }
        beats += 1;
        if args.real_time {
            thread::sleep(Duration::from_secs_f64(BEAT_S));
        }
    }
    if let Some(path) = &args.graph {
        std::fs::write(path, svg(run.control.hierarchy(), run.control.vocabulary()))
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    let measures = run.measures();
    eprintln!(
        "{} after {:.0} s: {:.1} m, {:.2} tanks, {} evaluations",
        if measures.complete {
            "nest complete"
        } else {
            "no nest"
        },
        measures.time_s,
        measures.path_m,
        measures.tanks,
        measures.evaluations
    );
    Ok(())
}

/// A line whenever another chain of RMs is in control.
fn tell(out: &mut impl Write, run: &Run, before: &mut String) -> io::Result<()> {
    let hierarchy = run.control.hierarchy();
    let names: Vec<&str> = hierarchy.active_path().map(|rm| hierarchy.name(rm)).collect();
    let path = names.join(" > ");
    if path != *before {
        writeln!(out, "{:8.2} s  {path}", run.world.now_s)?;
        *before = path;
    }
    Ok(())
}
