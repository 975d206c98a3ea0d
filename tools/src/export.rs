//! `export`: a recording as other tools want it.
//!
//! Must never write over a file that is there, nor leave half of one behind.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::process::ExitCode;

use serde_json::json;

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Profile {
    /// MCAP of the profile ros2: standard messages in CDR, for RViz, PlotJuggler, rosbags, `ros2 bag`
    Ros2,
}

/// Writes `from` to `to`.
pub(crate) fn export(from: &Path, to: &Path, profile: Profile, as_json: bool) -> ExitCode {
    let Profile::Ros2 = profile;
    let bad = |message: String| {
        eprintln!("{message}");
        ExitCode::from(2)
    };
    let (shown, out) = (from.display(), to.display());
    let bytes = match std::fs::read(from) {
        Ok(bytes) => bytes,
        Err(e) => return bad(format!("{shown}: cannot be read: {e}; expected a recording")),
    };
    let file = match File::create_new(to) {
        Ok(file) => file,
        Err(e) => {
            return bad(format!(
                "{out}: cannot be made: {e}; expected the name of a new file"
            ));
        }
    };
    match recording::ros2::export(&bytes, BufWriter::new(file)) {
        Ok(messages) if as_json => println!("{}", json!({"file": to, "messages": messages})),
        Ok(messages) => println!("{out}: {messages} messages for ROS 2"),
        Err(message) => {
            // What it is called is ours: it was made a moment ago.
            let _ = std::fs::remove_file(to);
            return bad(format!("{shown}: {message}"));
        }
    }
    ExitCode::SUCCESS
}
